#include "io/formats/databases/tensor_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/files/little_endian.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr std::string_view kTensorMagic("tensor_file\0", 12);

// Bytes of one entry, by type number: none, then (u)int8, 16, 32, 64 in pairs unsigned, signed,
// then float16, float32, float64.
constexpr std::array<size_t, 12> kItemSizes = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
constexpr uint8_t kUint8 = 1;
constexpr uint8_t kFloat32 = 10;

// A name from a file as it may stand in a message: short and printable.
std::string Quote(std::string_view name) {
  std::string quoted = "'";
  for (const char c : name.substr(0, 32)) quoted += c >= ' ' && c <= '~' ? c : '?';
  return quoted + (name.size() > 32 ? "...'" : "'");
}

// Takes the header apart from front to back, never past its end.
class Cursor {
 public:
  Cursor(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  std::string_view Bytes(size_t count) {
    if (count > bytes_.size() - position_) {
      throw ErrorIn(ErrorKind::kFormat, source_,
                    "truncated: the header goes on beyond the file's " +
                        std::to_string(bytes_.size()) + " bytes; get it once more")
          .About("bytes", bytes_.size());
    }
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
  }

  size_t position() const { return position_; }

  template <typename T>
  T Number() {
    return LoadLittleEndian<T>(Bytes(sizeof(T)).data());
  }

 private:
  std::string_view bytes_;
  size_t position_ = 0;
  const std::string& source_;
};

}  // namespace

void TensorFile::Fail(std::string_view field, const std::string& problem, ErrorKind kind,
                      std::string_view value) const {
  throw ErrorIn(kind, source_, "field " + Quote(field) + " " + problem).About(field, value);
}

bool LooksLikeTensorFile(std::string_view bytes) { return bytes.starts_with(kTensorMagic); }

TensorFile::TensorFile(std::string_view bytes, const std::string& source) : source_(source) {
  if (!LooksLikeTensorFile(bytes)) {
    throw ErrorIn(ErrorKind::kFormat, source, "not an RGL file: it must begin with tensor_file")
        .About("tensor_file");
  }
  Cursor cursor(bytes, source);
  cursor.Bytes(kTensorMagic.size());
  const int major = cursor.Number<uint8_t>();
  const int minor = cursor.Number<uint8_t>();
  if (major != 1 || minor != 0) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "tensor file version " + std::to_string(major) + "." + std::to_string(minor) +
                      "; only version 1.0 can be read")
        .About("version", std::to_string(major) + "." + std::to_string(minor));
  }
  // Nothing is reserved by this count: each field must first show its bytes.
  const auto field_count = cursor.Number<uint32_t>();
  for (uint32_t i = 0; i < field_count; ++i) {
    Field field;
    field.name = cursor.Bytes(cursor.Number<uint16_t>());
    const int ndim = cursor.Number<uint16_t>();
    field.dtype = cursor.Number<uint8_t>();
    const auto offset = cursor.Number<uint64_t>();
    if (field.dtype == 0 || field.dtype >= kItemSizes.size()) {
      Fail(field.name, "has the unknown type number " + std::to_string(field.dtype),
           ErrorKind::kUnknown, std::to_string(field.dtype));
    }
    if (offset > bytes.size()) {
      Fail(field.name,
           "starts at byte " + std::to_string(offset) + " of a file of " +
               std::to_string(bytes.size()) + " bytes",
           ErrorKind::kFormat, "beyond the file");
    }
    const size_t available = bytes.size() - offset;
    size_t size = kItemSizes[field.dtype];
    for (int k = 0; k < ndim; ++k) {
      const auto extent = cursor.Number<uint64_t>();
      if (extent == 0) {
        Fail(field.name, "is empty: dimension " + std::to_string(k) + " is 0", ErrorKind::kFormat,
             "0");
      }
      if (extent > static_cast<uint64_t>(std::numeric_limits<int>::max()) ||
          extent > available / size) {
        Fail(field.name,
             "reaches past the end of the file: dimension " + std::to_string(k) + " is " +
                 std::to_string(extent) + ", but only " + std::to_string(available) +
                 " bytes follow byte " + std::to_string(offset),
             ErrorKind::kFormat, "beyond the file");
      }
      size *= extent;
      field.shape.push_back(static_cast<int>(extent));
    }
    if (size > available) {
      Fail(field.name, "reaches past the end of the file", ErrorKind::kFormat, "beyond the file");
    }
    field.data = bytes.substr(offset, size);
    fields_.push_back(std::move(field));
  }
  CheckApart(bytes, cursor.position());
}

void TensorFile::CheckApart(std::string_view bytes, size_t header_size) const {
  std::vector<std::string_view> names;
  for (const Field& field : fields_) names.push_back(field.name);
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end()) {
    Fail(*twice, "comes twice; there must be one field of each name", ErrorKind::kConflict);
  }
  struct Part {
    size_t begin, end;
    std::string_view name;
  };
  std::vector<Part> parts;
  for (const Field& field : fields_) {
    const auto begin = static_cast<size_t>(field.data.data() - bytes.data());
    parts.push_back({begin, begin + field.data.size(), field.name});
  }
  std::ranges::sort(parts, {}, &Part::begin);
  size_t end = header_size;
  std::string before = "the header";
  for (const Part& part : parts) {
    if (part.begin < end) {
      Fail(part.name,
           "starts at byte " + std::to_string(part.begin) + ", inside " + before +
               ", which ends at byte " + std::to_string(end),
           ErrorKind::kConflict, std::to_string(part.begin));
    }
    end = part.end;
    before = "field " + Quote(part.name);
  }
}

const TensorFile::Field& TensorFile::Find(std::string_view name, uint8_t dtype, int ndim) const {
  for (const Field& field : fields_) {
    if (field.name != name) continue;
    if (field.dtype != dtype) {
      Fail(name,
           "has type number " + std::to_string(field.dtype) + "; it must be " +
               std::to_string(dtype) + (dtype == kFloat32 ? " (float32)" : " (uint8)"),
           ErrorKind::kFormat, std::to_string(field.dtype));
    }
    if (field.shape.size() != static_cast<size_t>(ndim)) {
      Fail(name,
           "has " + std::to_string(field.shape.size()) + " dimensions; it must have " +
               std::to_string(ndim),
           ErrorKind::kMismatch, std::to_string(field.shape.size()));
    }
    return field;
  }
  Fail(name, "is missing; a material of the RGL database has it", ErrorKind::kMissing);
}

Tensor TensorFile::Float32(std::string_view name, int ndim) const {
  const Field& field = Find(name, kFloat32, ndim);
  Tensor tensor{field.shape, std::vector<double>(field.data.size() / sizeof(float))};
  for (size_t i = 0; i < tensor.values.size(); ++i) {
    tensor.values[i] = LoadLittleEndian<float>(field.data.data() + i * sizeof(float));
    if (!std::isfinite(tensor.values[i])) {
      Fail(name, "has an entry that is not finite: number " + std::to_string(i), ErrorKind::kRange,
           std::to_string(i));
    }
  }
  return tensor;
}

bool TensorFile::Has(std::string_view name) const {
  return std::ranges::find(fields_, name, &Field::name) != fields_.end();
}

std::string_view TensorFile::Bytes(std::string_view name) const {
  return Find(name, kUint8, 1).data;
}

uint8_t TensorFile::Byte(std::string_view name) const {
  const Field& field = Find(name, kUint8, 1);
  if (field.data.size() != 1) Fail(name, "must have one entry", ErrorKind::kFormat);
  return LoadLittleEndian<uint8_t>(field.data.data());
}

void TensorFileWriter::AddFloat32(const std::string& name, const std::vector<int>& shape,
                                  const std::vector<float>& values) {
  size_t count = 1;
  for (const int size : shape) count *= static_cast<size_t>(size);
  if (count != values.size()) {
    throw Error(ErrorKind::kMismatch, "field " + Quote(name) + " has another size than shape")
        .About(name, values.size());
  }
  std::string data(values.size() * sizeof(float), '\0');
  std::memcpy(data.data(), values.data(), data.size());
  fields_.push_back({name, kFloat32, shape, std::move(data)});
}

void TensorFileWriter::AddBytes(const std::string& name, std::string_view bytes) {
  fields_.push_back({name, kUint8, {static_cast<int>(bytes.size())}, std::string(bytes)});
}

std::string TensorFileWriter::Bytes() const {
  constexpr size_t kAlignment = sizeof(double);
  size_t offset = kTensorMagic.size() + 2 + sizeof(uint32_t);
  for (const Field& field : fields_) {
    offset += sizeof(uint16_t) + field.name.size() + sizeof(uint16_t) + 1 +
              sizeof(uint64_t) * (1 + field.shape.size());
  }
  std::string bytes(kTensorMagic);
  const auto add = [&bytes](const auto& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  bytes += std::string("\1\0", 2);
  add(static_cast<uint32_t>(fields_.size()));
  for (const Field& field : fields_) {
    offset = (offset + kAlignment - 1) / kAlignment * kAlignment;
    add(static_cast<uint16_t>(field.name.size()));
    bytes += field.name;
    add(static_cast<uint16_t>(field.shape.size()));
    add(field.dtype);
    add(static_cast<uint64_t>(offset));
    for (const int size : field.shape) add(static_cast<uint64_t>(size));
    offset += field.data.size();
  }
  for (const Field& field : fields_) {
    bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment);
    bytes += field.data;
  }
  return bytes;
}

}  // namespace trilobe
