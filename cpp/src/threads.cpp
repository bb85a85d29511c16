// SPDX-License-Identifier: Apache-2.0
#include "ltmd/threads.h"

#include <IlmThreadPool.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr int max_thread_count = 1024;

int core_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

std::atomic<int> requested_count{0};

// Never destroyed: at the end of a process that unloads modules in its own order, joining threads
// can hang.
IlmThread::ThreadPool& pool() {
    static auto* instance = new IlmThread::ThreadPool(0);
    return *instance;
}

struct Work {
    std::size_t count, grain, pieces;
    const std::function<void(std::size_t, std::size_t)>& body;
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr error;

    void run() {
        for (std::size_t piece; (piece = next.fetch_add(1, std::memory_order_relaxed)) < pieces;) {
            try {
                body(piece * grain, std::min(count, (piece + 1) * grain));
            } catch (...) {
                std::lock_guard lock(mutex);
                if (!error) error = std::current_exception();
                next.store(pieces, std::memory_order_relaxed);
            }
        }
    }
};

class WorkTask : public IlmThread::Task {
public:
    WorkTask(IlmThread::TaskGroup* group, Work& work) : Task(group), work_(work) {}
    void execute() override { work_.run(); }

private:
    Work& work_;
};

}  // namespace

void set_thread_count(int count) {
    if (count < 0 || count > max_thread_count)
        throw InvalidInput("thread count " + std::to_string(count) +
                           " is outside 0 (one per core) to " + std::to_string(max_thread_count));
    requested_count = count;
}

int thread_count() {
    const int count = requested_count;
    return count > 0 ? count : core_count();
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0) return;
    Work work{count, grain, (count + grain - 1) / grain, body, {}, {}, {}};
    const int helpers = static_cast<int>(std::min<std::size_t>(thread_count(), work.pieces)) - 1;
    if (helpers > 0) {
        static std::mutex resize;
        {
            std::lock_guard lock(resize);
            if (pool().numThreads() < helpers) pool().setNumThreads(helpers);
        }
        IlmThread::TaskGroup group;  // its destructor waits for the tasks
        for (int i = 0; i < helpers; ++i) pool().addTask(new WorkTask(&group, work));
        work.run();
    } else {
        work.run();
    }
    if (work.error) std::rethrow_exception(work.error);
}

}  // namespace ltmd::inline v0
