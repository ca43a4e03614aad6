#ifndef TRILOBE_IO_FORMATS_DATABASES_TENSOR_FILE_H_
#define TRILOBE_IO_FORMATS_DATABASES_TENSOR_FILE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {

// A dense array of finite numbers, last dimension fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<double> values;
};

// The file format of the RGL database: named arrays, little-endian:
//   char[12] "tensor_file\0", uint8 version[2] = {1, 0}, uint32 field count; for each field
//   uint16 name length, name, uint16 ndim, uint8 dtype, uint64 offset, uint64 shape[ndim];
//   then the arrays at their offsets from the start of the file.
// Refers to the bytes, which must outlive it.
class TensorFile {
 public:
  // Throws Error if a field exceeds the file, fields overlap, or a name occurs twice.
  TensorFile(std::string_view bytes, const std::string& source);

  // A float32 array with `ndim` dimensions. Throws Error if it is missing, has another type or
  // number of dimensions, or has an entry that is not finite.
  Tensor Float32(std::string_view name, int ndim) const;

  bool Has(std::string_view name) const;

  // A uint8 array with one dimension, as a view into the file. Throws Error likewise.
  std::string_view Bytes(std::string_view name) const;

  // The only entry of a uint8 array. Throws Error likewise.
  uint8_t Byte(std::string_view name) const;

  // Throws Error with file, field and problem.
  [[noreturn]] void Fail(std::string_view field, const std::string& problem,
                         ErrorKind kind = ErrorKind::kFormat, std::string_view value = "") const;

 private:
  struct Field {
    std::string name;
    uint8_t dtype = 0;
    std::vector<int> shape;
    std::string_view data;  // product of shape x item size bytes
  };
  void CheckApart(std::string_view bytes, size_t header_size) const;
  const Field& Find(std::string_view name, uint8_t dtype, int ndim) const;

  std::string source_;
  std::vector<Field> fields_;
};

// Whether bytes begin like a tensor file.
bool LooksLikeTensorFile(std::string_view bytes);

// Builds a tensor file. Fields keep their order and are aligned to their item size.
class TensorFileWriter {
 public:
  void AddFloat32(const std::string& name, const std::vector<int>& shape,
                  const std::vector<float>& values);
  void AddBytes(const std::string& name, std::string_view bytes);
  std::string Bytes() const;

 private:
  struct Field {
    std::string name;
    uint8_t dtype;
    std::vector<int> shape;
    std::string data;
  };
  std::vector<Field> fields_;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_TENSOR_FILE_H_
