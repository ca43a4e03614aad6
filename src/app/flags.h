#ifndef TRILOBE_APP_FLAGS_H_
#define TRILOBE_APP_FLAGS_H_

#include <gflags/gflags_declare.h>

// Flags that several commands take.
DECLARE_int32(threads);
DECLARE_int64(seed);
DECLARE_double(noise);
DECLARE_string(weighting);
DECLARE_string(out);

namespace trilobe {

struct SourceOptions;

// --threads, with 0 meaning all cores. Throws Error if negative.
int ThreadsFromFlags();

// --noise, --seed and --threads for LoadSource.
SourceOptions SourceOptionsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_FLAGS_H_
