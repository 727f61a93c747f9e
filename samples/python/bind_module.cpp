// The extension module limn._limn. Its functions take what samples/python/limn/ has made of Python's arguments.

#include <opensubdiv/far/error.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <new>

#include "samples/python/bindings.h"
#include "sdf/error.h"
#include "sdf/version.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// Raised with the parts of the fault as attributes, beside the line that the command line prints.
void raise_input_error(const py::object& type, const InputError& error) {
  const InputFault& fault = error.fault();
  const py::object raised = type(error.what());
  raised.attr("file") = fault.file;
  raised.attr("field") = fault.field;
  raised.attr("value") = fault.value;
  raised.attr("problem") = fault.problem;
  raised.attr("expected") = fault.expected;
  PyErr_SetObject(type.ptr(), raised.ptr());
}

}  // namespace

void bind_errors(py::module_& module) {
  static PyObject* input_error = nullptr;
  static PyObject* machine_error = nullptr;
  input_error = PyErr_NewExceptionWithDoc("limn.InputError",
                                          "What a caller can cause: the line that the command line prints, and its parts as attributes "
                                          "file, field, value, problem and expected.",
                                          PyExc_ValueError, nullptr);
  machine_error = PyErr_NewExceptionWithDoc("limn.MachineError", "The machine failed: a full disk, a helper program that is not installed.",
                                            PyExc_RuntimeError, nullptr);
  module.attr("InputError") = py::handle(input_error);
  module.attr("MachineError") = py::handle(machine_error);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const InputError& error) {
      raise_input_error(py::reinterpret_borrow<py::object>(input_error), error);
    } catch (const MachineError& error) {
      PyErr_SetString(machine_error, error.what());
    } catch (const Cancelled&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const std::bad_alloc&) {
      PyErr_SetString(PyExc_MemoryError, "out of memory; use fewer voxels or a lower level");
    }
  });
}

}  // namespace limn::python

PYBIND11_MODULE(_limn, module) {
  using namespace limn::python;
  // It would print lines of its own about meshes that the audit and our errors speak of.
  OpenSubdiv::Far::SetWarningCallback([](const char*) {});
  module.doc() = "What the package limn is made of; use that.";
  module.attr("__version__") = limn::kVersion;
  bind_errors(module);
  bind_fields(module);
  bind_meshes(module);
  bind_level_sets(module);
  bind_scenes(module);
  bind_pictures(module);
  bind_borders(module);
  bind_lines(module);
  bind_comparisons(module);
  bind_studies(module);
  bind_judge(module);
  bind_lists(module);
}
