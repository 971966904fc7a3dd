// Times rounds by the wall clock and by what this process computed, and prints the fastest and the median of both.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <time.h>
#include <vector>

class Rounds {
public:
    template <class Work>
    void time(Work work) {
        const double cpu = computed_ns();
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
        walls_ns.push_back(took.count());
        cpus_ns.push_back(std::max(0.0, computed_ns() - cpu - asking_ns));
    }

    bool empty() const { return walls_ns.empty(); }

    // Only the second half: the rounds before it warm up.
    void leave_first_half_out() {
        walls_ns.erase(walls_ns.begin(), walls_ns.begin() + walls_ns.size() / 2);
        cpus_ns.erase(cpus_ns.begin(), cpus_ns.begin() + cpus_ns.size() / 2);
    }

    // Fastest and median by the wall clock, fastest and median by the processor: nanoseconds.
    void print() {
        std::sort(walls_ns.begin(), walls_ns.end());
        std::sort(cpus_ns.begin(), cpus_ns.end());
        std::printf("%.0f %.0f %.0f %.0f", walls_ns.front(), walls_ns[walls_ns.size() / 2], cpus_ns.front(), cpus_ns[cpus_ns.size() / 2]);
    }

private:
    static double computed_ns() {
        struct timespec now;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
    }

    // What the processor's clock shows for no work at all.
    static double cost_of_asking_ns() {
        double least_ns = 1e9;
        for (int round = 0; round < 1000; ++round) {
            const double cpu = computed_ns();
            const auto start = std::chrono::steady_clock::now();
            const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
            if (took.count() >= 0.0) least_ns = std::min(least_ns, computed_ns() - cpu);
        }
        return least_ns;
    }

    const double asking_ns = cost_of_asking_ns();
    std::vector<double> walls_ns, cpus_ns;
};

