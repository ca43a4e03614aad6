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

template <typename T>
using NumpyArray = nanobind::ndarray<nanobind::numpy, T>;

// One that owns these values.
template <typename T>
NumpyArray<T> OwnedArray(std::vector<T> values, std::initializer_list<size_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  if (kept->empty()) kept->reserve(1);  // an array of no entries has an address, too
  T* const data = kept->data();
  nanobind::capsule owner(
      kept.release(), [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  return NumpyArray<T>(data, shape, owner);
}

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_OWNED_ARRAY_H_
