// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"
#include "ltmd/threads.h"

namespace ltmd::python {

void bind_threads(py::module_& module) {
    using namespace py::literals;
    module.def(
        "set_threads", &set_thread_count, "count"_a,
        R"(Set how many threads the library uses: 1 to 1024, or 0 for one per core (the default).

Results have the same bits for any count. Raises ValueError outside that range.)");
    module.def("threads", &thread_count, "The number of threads in use.");
}

}  // namespace ltmd::python
