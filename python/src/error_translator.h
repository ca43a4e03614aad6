#ifndef TRILOBE_PYTHON_SRC_ERROR_TRANSLATOR_H_
#define TRILOBE_PYTHON_SRC_ERROR_TRANSLATOR_H_

#include <nanobind/nanobind.h>

#include <exception>
#include <string>
#include <string_view>

#include "trilobe/core/base/error.h"

namespace trilobe {

// An Error as the trilobe.Error of Python, with its kind and facts; None stands for those that are
// not known. Its text may have been cut in the middle of a character, or name a file that is not
// in UTF-8.
inline nanobind::object PythonError(const Error& error) {
  const auto text = [](std::string_view utf8) {
    return nanobind::steal<nanobind::object>(PyUnicode_DecodeUTF8(
        utf8.data(), static_cast<Py_ssize_t>(utf8.size()), "backslashreplace"));
  };
  const auto fact = [&](const std::string& known) {
    return known.empty() ? nanobind::object(nanobind::none()) : text(known);
  };
  const ErrorFacts& facts = error.facts();
  const nanobind::object line =
      facts.line == 0 ? nanobind::object(nanobind::none()) : nanobind::int_(facts.line);
  // Imported only when needed, so that a module can be loaded without the package.
  const nanobind::module_ module = nanobind::module_::import_("trilobe._model.error");
  return module.attr("Error")(module.attr("in_keywords")(text(error.what())),
                              nanobind::arg("kind") = text(NameOf(error.kind())),
                              nanobind::arg("file") = fact(facts.file),
                              nanobind::arg("line") = line, nanobind::arg("key") = fact(facts.key),
                              nanobind::arg("value") = fact(facts.value));
}

// Makes the Errors that a module's functions throw exceptions of Python.
inline void TranslateErrors() {
  nanobind::register_exception_translator(
      [](const std::exception_ptr& exception, void* /*payload*/) {
        try {
          std::rethrow_exception(exception);
        } catch (const Error& error) {
          const nanobind::object raised = PythonError(error);
          PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(raised.ptr())), raised.ptr());
        }
      },
      nullptr);
}

}  // namespace trilobe

#endif  // TRILOBE_PYTHON_SRC_ERROR_TRANSLATOR_H_
