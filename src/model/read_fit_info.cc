#include "model/read_fit_info.h"

#include <limits>
#include <string>

#include "model/model_format.h"

namespace trilobe {
namespace {

void Read(const JsonNode& node, std::string* value) { *value = node.String(); }
void Read(const JsonNode& node, double* value) { *value = node.Number(); }
void Read(const JsonNode& node, int* value) {
  *value = node.Integer(std::numeric_limits<int>::max());
}

}  // namespace

FitInfo ReadFitInfo(const JsonNode& root) {
  FitInfo fit;
  if (!root.has("fit")) return fit;
  const JsonNode node = root["fit"].CheckObject();
  VisitFitInfo(&fit, [&](const std::string& key, auto* value) {
    if (node.has(key)) Read(node[key], value);
  });
  return fit;
}

}  // namespace trilobe
