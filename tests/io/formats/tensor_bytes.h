#ifndef TRILOBE_TESTS_IO_FORMATS_TENSOR_BYTES_H_
#define TRILOBE_TESTS_IO_FORMATS_TENSOR_BYTES_H_

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace trilobe {

// One field of a tensor file, as its header describes it. Tests may lie in `offset` and `shape`.
struct TensorField {
  std::string name;
  uint8_t dtype = 10;  // 1: uint8, 10: float32
  std::vector<uint64_t> shape;
  std::string data;
  int64_t offset = -1;  // from the start of the file; -1: where the data really are
};

template <typename T>
void AppendBytes(T value, std::string* bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes->append(raw, sizeof(T));
}

inline TensorField FloatField(const std::string& name, const std::vector<uint64_t>& shape,
                              const std::vector<float>& values) {
  TensorField field{name, 10, shape, "", -1};
  for (const float value : values) AppendBytes(value, &field.data);
  return field;
}

inline std::string TensorBytes(const std::vector<TensorField>& fields) {
  size_t data_offset = 12 + 2 + 4;
  for (const TensorField& field : fields) {
    data_offset += 2 + field.name.size() + 2 + 1 + 8 + 8 * field.shape.size();
  }
  std::string bytes("tensor_file\0\1\0", 14);
  AppendBytes(static_cast<uint32_t>(fields.size()), &bytes);
  for (const TensorField& field : fields) {
    AppendBytes(static_cast<uint16_t>(field.name.size()), &bytes);
    bytes += field.name;
    AppendBytes(static_cast<uint16_t>(field.shape.size()), &bytes);
    AppendBytes(field.dtype, &bytes);
    AppendBytes(
        field.offset < 0 ? static_cast<uint64_t>(data_offset) : static_cast<uint64_t>(field.offset),
        &bytes);
    for (const uint64_t extent : field.shape) AppendBytes(extent, &bytes);
    data_offset += field.data.size();
  }
  for (const TensorField& field : fields) bytes += field.data;
  return bytes;
}

// The tables of a small RGL material. Rows run along phi, columns along theta.
struct TinyRgl {
  std::vector<float> phi_i = {0};
  std::vector<float> theta_i = {0, 0.6F, 1.5707964F};
  int rows = 4, columns = 5;          // extents of vndf
  int rgb_rows = 3, rgb_columns = 4;  // extents of rgb
  std::vector<float> ndf, sigma;      // [2][columns]
  std::vector<float> vndf;            // [phi_i][theta_i][rows][columns]
  std::vector<float> rgb;             // [phi_i][theta_i][3][rgb_rows][rgb_columns]
  std::vector<bool> valid;            // [phi_i][theta_i][rgb_rows][rgb_columns], or no such field

  void FillConstant(float ndf_value, float sigma_value, float rgb_value) {
    const size_t slices = phi_i.size() * theta_i.size();
    ndf.assign(2 * columns, ndf_value);
    sigma.assign(2 * columns, sigma_value);
    vndf.assign(slices * rows * columns, 1);
    rgb.assign(slices * 3 * rgb_rows * rgb_columns, rgb_value);
  }

  // The field `valid`, with 1 for measured, everywhere.
  void MaskAll() { valid.assign(phi_i.size() * theta_i.size() * rgb_rows * rgb_columns, true); }

  void SetMask(int slice, int row, int column, bool value) {
    valid[(slice * rgb_rows + row) * rgb_columns + column] = value;
  }

  // Uneven numbers in (0, 1), the same on every machine.
  void FillRandom(uint32_t seed) {
    FillConstant(0, 0, 0);
    for (std::vector<float>* table : {&ndf, &sigma, &vndf, &rgb}) {
      for (float& value : *table) {
        seed = seed * 1664525U + 1013904223U;
        value = (static_cast<float>(seed >> 8U) + 0.5F) / 16777216.0F;
      }
    }
  }

  std::vector<TensorField> Fields() const {
    const uint64_t p = phi_i.size(), t = theta_i.size();
    const auto r = static_cast<uint64_t>(rows), c = static_cast<uint64_t>(columns);
    std::vector<TensorField> fields = {
        FloatField("phi_i", {p}, phi_i),
        FloatField("theta_i", {t}, theta_i),
        FloatField("ndf", {2, c}, ndf),
        FloatField("sigma", {2, c}, sigma),
        FloatField("vndf", {p, t, r, c}, vndf),
        FloatField("rgb",
                   {p, t, 3, static_cast<uint64_t>(rgb_rows), static_cast<uint64_t>(rgb_columns)},
                   rgb),
        TensorField{"jacobian", 1, {1}, "\1", -1}};
    if (valid.empty()) return fields;
    std::string bits((valid.size() + 7) / 8, '\0');
    for (size_t i = 0; i < valid.size(); ++i) {
      if (valid[i]) bits[i / 8] = static_cast<char>(bits[i / 8] | 0x80 >> i % 8);
    }
    fields.push_back({"valid", 1, {bits.size()}, bits, -1});
    return fields;
  }

  std::string Bytes() const { return TensorBytes(Fields()); }
};

}  // namespace trilobe

#endif  // TRILOBE_TESTS_IO_FORMATS_TENSOR_BYTES_H_
