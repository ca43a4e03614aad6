#ifndef TRILOBE_APP_DESCRIBE_H_
#define TRILOBE_APP_DESCRIBE_H_

#include <string>

namespace trilobe {

// Print `trilobe info` of a measurement and of a model file, as a table or, with --json, as one
// object. Both throw Error for bad input.
void DescribeMeasurement(const std::string& source);
void DescribeModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_APP_DESCRIBE_H_
