#ifndef TRILOBE_PYTHON_NAMED_VALUES_H_
#define TRILOBE_PYTHON_NAMED_VALUES_H_

#include <nanobind/nanobind.h>

namespace trilobe::python {

// A dict whose keys are names; the stubs of the modules say dict[str, Any].
using NamedValues = nanobind::typed<nanobind::dict, nanobind::str, nanobind::any>;

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_NAMED_VALUES_H_
