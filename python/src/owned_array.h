#ifndef TRILOBE_PYTHON_OWNED_ARRAY_H_
#define TRILOBE_PYTHON_OWNED_ARRAY_H_

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace trilobe::python {

// A numpy array that owns these values.
template <typename T>
nanobind::object OwnedArray(std::vector<T> values, std::initializer_list<size_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  if (kept->empty()) kept->reserve(1);  // an array of no entries has an address, too
  T* const data = kept->data();
  nanobind::capsule owner(
      kept.release(), [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  return nanobind::cast(nanobind::ndarray<nanobind::numpy, T>(data, shape, owner));
}

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_OWNED_ARRAY_H_
