// Where the time of a frame goes: blocks that add their seconds to a stage, each also a log stage of PETSc.
#include <petscsys.h>
#include <pybind11/pybind11.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// The open blocks of all stages, the innermost one last.
struct Block {
    double start, within;  // seconds, and those of the blocks inside of it
    bool logged;           // it is a log stage of PETSc
};

struct OpenBlocks {
    std::vector<Block> list;
};

class Stage {
 public:
    Stage(py::str name, py::dict seconds, std::shared_ptr<OpenBlocks> open, int log)
        : name_(std::move(name)), seconds_(std::move(seconds)), open_(std::move(open)), log_(log) {}

    void enter() {
        const bool logged = log_ >= 0 && counts();
        if (logged) (void)PetscLogStagePush(log_);
        open_->list.push_back({now(), 0.0, logged});
    }

    void exit(const py::object&, const py::object&, const py::object&) {
        if (open_->list.empty()) throw std::runtime_error("a stage ends that has not begun");
        const Block block = open_->list.back();
        const double taken = now() - block.start;
        open_->list.pop_back();
        seconds_[name_] = py::float_(seconds_[name_].cast<double>() + (taken - block.within));
        if (!open_->list.empty()) open_->list.back().within += taken;
        if (block.logged) (void)PetscLogStagePop();
    }

    const py::str& name() const { return name_; }

 private:
    // Whether PETSc counts events: without them its stages name nothing.
    static bool counts() {
        PetscBool active = PETSC_FALSE;
        (void)PetscLogIsActive(&active);
        return active == PETSC_TRUE;
    }

    py::str name_;
    py::dict seconds_;
    std::shared_ptr<OpenBlocks> open_;
    int log_;
};

}  // namespace

void bind_stages(py::module_& m) {
    py::class_<OpenBlocks, std::shared_ptr<OpenBlocks>>(m, "OpenBlocks",
                                                        "Blocks that have begun, of stages that may lie within others.")
        .def(py::init<>());
    py::class_<Stage>(m, "Stage",
                      R"(Counts the time of `with` blocks, without that of blocks of stages within them.

Args:
  name: of the stage.
  seconds: of all stages by name, float, which it adds to.
  open: blocks that have begun, of all stages.
  log: PETSc's log stage, pushed where PETSc counts events; below 0: none.)")
        .def(py::init<py::str, py::dict, std::shared_ptr<OpenBlocks>, int>(), py::arg("name"), py::arg("seconds"),
             py::arg("open"), py::arg("log") = -1)
        .def_property_readonly("name", &Stage::name, "Of the stage.")
        .def("__enter__", &Stage::enter, "Begins a block.")
        .def("__exit__", &Stage::exit, py::arg("kind"), py::arg("error"), py::arg("trace"),
             "Ends the block that began last.");
}
