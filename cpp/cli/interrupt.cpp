// SPDX-License-Identifier: Apache-2.0
#include "interrupt.h"

#include <csignal>

namespace ltmd::cli {
namespace {

volatile std::sig_atomic_t mark = 0;

extern "C" void note(int signal) {
    mark = 1;
    std::signal(signal, SIG_DFL);
}

}  // namespace

void watch_for_interrupt() {
    std::signal(SIGINT, note);
    std::signal(SIGTERM, note);
}

bool is_interrupted() { return mark != 0; }

}  // namespace ltmd::cli
