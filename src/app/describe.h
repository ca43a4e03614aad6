#ifndef TRILOBE_APP_DESCRIBE_H_
#define TRILOBE_APP_DESCRIBE_H_

#include <string>

namespace trilobe {

// The two halves of `trilobe info`: print what a measurement, or a model file, is, as a table or,
// with
// --json, as one object. Both throw Error for bad input.
void DescribeMeasurement(const std::string& source);
void DescribeModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_APP_DESCRIBE_H_
