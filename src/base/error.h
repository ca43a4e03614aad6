#ifndef TRILOBE_BASE_ERROR_H_
#define TRILOBE_BASE_ERROR_H_

#include <stdexcept>

namespace trilobe {

// Bad input or an impossible request. what() is one line that a user can act on: what is wrong,
// where (file, bin, key), and what to do. The program prints it and exits with status 1.
// Programming errors are glog CHECKs, never this.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace trilobe

#endif  // TRILOBE_BASE_ERROR_H_
