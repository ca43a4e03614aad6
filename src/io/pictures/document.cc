#include "io/pictures/document.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "io/pictures/sha256.h"
#include "io/pictures/web_files.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
std::string_view WebText(std::string_view name) {
  for (const EmbeddedFile& file : WebFiles()) {
    if (file.name == name) return file.text;
  }
  throw Error(ErrorKind::kMissing, "the program was built without web/" + std::string(name))
      .About("web", name);
}

namespace {

// Keeps texts from ending the element that they stand in: "<" occurs in JSON within strings alone.
std::string EscapeForScript(std::string_view json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string DataElement(std::string_view id, std::string_view json) {
  return R"(<script type="application/json" id=")" + std::string(id) + R"(">)" +
         EscapeForScript(json) + "</script>";
}

std::string Shaders() {
  nlohmann::ordered_json json;
  for (const EmbeddedFile& file : WebFiles()) {
    if (file.name.ends_with(".glsl")) json[std::string(file.name)] = file.text;
  }
  return json.dump();
}

// `text` without its imports and exports, after the modules that these name. An import is a line
// `import {a, b} from './c.js';`.
void AddModule(std::string_view name, std::vector<std::string>* added, std::string* script) {
  if (std::ranges::find(*added, name) != added->end()) return;
  added->emplace_back(name);
  const std::string_view text = WebText(name);
  std::string own;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    std::string_view line = text.substr(at, end - at);
    at = end;
    if (line.starts_with("import ")) {
      const size_t from = line.find("'./"), quote = line.rfind('\'');
      if (from == std::string_view::npos || quote < from + 3) {
        throw Error(ErrorKind::kFormat,
                    "web/" + std::string(name) + ": an import that is not of one line")
            .About("web", name);
      }
      AddModule(line.substr(from + 3, quote - from - 3), added, script);
      continue;
    }
    if (line.starts_with("export ")) line.remove_prefix(std::string_view("export ").size());
    own += line;
  }
  *script += own + "\n";
}

std::string ModuleText(std::string_view name) {
  std::vector<std::string> added;
  std::string script = "\n";
  AddModule(name, &added, &script);
  return script;
}

// Content security policy of a page: it may load nothing from a network, and run its own scripts
// and styles by their SHA-256, and show these images.
class Policy {
 public:
  // An element whose text this page may run, or be styled by.
  std::string Element(const std::string& tag, const std::string& attributes,
                      const std::string& text) {
    (tag == "style" ? styles_ : scripts_) += " 'sha256-" + Base64(Sha256(text)) + "'";
    return "<" + tag + attributes + ">" + text + "</" + tag + ">";
  }
  std::string MetaElement(std::string_view images) const {
    return R"(<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src)" +
           scripts_ + "; style-src" + styles_ + "; img-src " + std::string(images) +
           R"(; base-uri 'none'; form-action 'none'">)";
  }

 private:
  std::string scripts_, styles_;
};

}  // namespace

std::string FormatDocument(std::string_view name, std::string_view title, std::string_view json,
                           std::string_view body) {
  constexpr std::string_view kBegin = "<!-- ", kEnd = " -->";
  std::string_view rest = WebText(name);
  std::string page, images;
  size_t policy_at = 0;
  Policy policy;
  while (true) {
    const size_t begin = rest.find(kBegin), end = rest.find(kEnd, begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) break;
    page += rest.substr(0, begin);
    const std::string_view what = rest.substr(begin + kBegin.size(), end - begin - kBegin.size());
    rest.remove_prefix(end + kEnd.size());
    const std::string_view file = what.substr(std::min(what.find(": ") + 2, what.size()));
    if (what == "title") {
      page += EscapedMarkup(title);
    } else if (what == "body") {
      page += body;
    } else if (what == "data") {
      page += DataElement("data", json);
    } else if (what == "shaders") {
      page += DataElement("shaders", Shaders());
    } else if (what.starts_with("style: ")) {
      page += policy.Element("style", "", "\n" + std::string(WebText(file)));
    } else if (what.starts_with("module: ")) {
      page += policy.Element("script", " type=\"module\"", ModuleText(file));
    } else if (what.starts_with("policy: ")) {
      policy_at = page.size();
      images = file;
    } else {
      throw Error(ErrorKind::kUnknown, "web/" + std::string(name) +
                                           ": nothing is known to stand for " + std::string(what))
          .About("web", what);
    }
  }
  page += rest;
  if (!images.empty()) page.insert(policy_at, policy.MetaElement(images));
  return page;
}

std::string Base64(std::string_view bytes, int line) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  int column = 0;
  for (size_t k = 0; k < bytes.size(); k += 3) {
    uint32_t three = 0;
    for (size_t b = 0; b < 3; ++b) {
      const char byte = k + b < bytes.size() ? bytes[k + b] : '\0';
      three = three << 8 | static_cast<unsigned char>(byte);
    }
    for (size_t d = 0; d < 4; ++d) {
      const bool padding = k + d > bytes.size();
      text += padding ? '=' : kDigits[three >> (6 * (3 - d)) & 63];
    }
    column += 4;
    if (line > 0 && column >= line && k + 3 < bytes.size()) {
      text += '\n';
      column = 0;
    }
  }
  return text;
}

}  // namespace trilobe
