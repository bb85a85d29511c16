// SPDX-License-Identifier: Apache-2.0
#include "../../cpp/src/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/threads.h"

namespace ltmd {
namespace {

TEST(Parallel, VisitsEachIndexOnce) {
    for (int threads : {1, 2, 5}) {
        set_thread_count(threads);
        std::vector<int> visits(100001, 0);
        parallel_for(visits.size(), 1000, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
    }
    set_thread_count(0);
}

TEST(Parallel, ThrowsWhatAPieceThrew) {
    EXPECT_THROW(parallel_for(100, 1,
                              [](std::size_t i, std::size_t) {
                                  if (i == 40) throw std::domain_error("forty");
                              }),
                 std::domain_error);
}

TEST(Parallel, ServesSeveralCallersAtOnce) {
    std::vector<std::size_t> sums(4, 0);
    std::vector<std::thread> callers;
    for (std::size_t& sum : sums)
        callers.emplace_back([&sum] {
            for (int repeat = 0; repeat < 200; ++repeat) {
                std::vector<std::size_t> parts(10, 0);
                parallel_for(1000, 100, [&](std::size_t begin, std::size_t end) {
                    parts[begin / 100] = end - begin;
                });
                for (std::size_t part : parts) sum += part;
            }
        });
    for (auto& caller : callers) caller.join();
    EXPECT_EQ(sums, std::vector<std::size_t>(4, 200000));
}

TEST(Threads, RefusesImpossibleCounts) {
    EXPECT_THROW(set_thread_count(-1), InvalidInput);
    EXPECT_THROW(set_thread_count(1025), InvalidInput);
}

}  // namespace
}  // namespace ltmd
