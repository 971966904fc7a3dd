// Times bayestracking on lines of step,kind,id,x,y: kind 1 is a detection.
// tracker_bayes FILE ekf|ukf nn|nnjpda STEPS; prints nanoseconds of the median step of the second half, and the tracks at the end.
#include "stopwatch.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>
#include "bayes_tracking/ekfilter.h"
#include "bayes_tracking/models.h"
#include "bayes_tracking/multitracker.h"
#include "bayes_tracking/ukfilter.h"

using namespace MTRK;
using namespace Models;

// What the library leaves to its user: when a track is lost, and how one begins.
template <class Filter>
bool MTRK::isLost(const Filter* filter, double most) {
    return filter->X(0, 0) + filter->X(2, 2) > most * most;
}

template <class Filter>
bool MTRK::initialize(Filter*& filter, sequence_t& sightings, observ_model_t) {
    const double seconds = sightings.back().time - sightings.front().time;
    FM::Vec velocity((sightings.back().vec - sightings.front().vec) / seconds);
    FM::Vec state(4);
    FM::SymMatrix covariance(4, 4);
    state[0] = sightings.back().vec[0];
    state[1] = velocity[0];
    state[2] = sightings.back().vec[1];
    state[3] = velocity[1];
    covariance.clear();
    covariance(0, 0) = covariance(2, 2) = 0.04;
    covariance(1, 1) = covariance(3, 3) = 1.0;
    filter = new Filter(4);
    filter->init(state, covariance);
    return true;
}

using Steps = std::vector<std::vector<std::pair<double, double>>>;

template <class Filter>
static void run(const Steps& steps, association_t association) {
    MultiTracker<Filter, 4> tracker;
    CVModel motion(0.6, 0.6);
    CartesianModel observation(0.1, 0.1);
    FM::Vec place(2);
    Rounds rounds;
    for (std::size_t step = 0; step < steps.size(); ++step) {
        rounds.time([&] {
            motion.update(0.1);
            tracker.predict(motion);
            for (const auto& seen : steps[step]) {
                place[0] = seen.first;
                place[1] = seen.second;
                tracker.addObservation(place, 0.1 * (step + 1));
            }
            tracker.process(observation, association, 3, 0.15, 1.0);
        });
    }
    rounds.leave_first_half_out();
    rounds.print();
    std::printf(" %d\n", tracker.size());
}

int main(int count, char** arguments) {
    if (count != 5) return 2;
    std::ifstream file(arguments[1]);
    const std::size_t most = std::atoi(arguments[4]);
    Steps steps;
    for (std::string line; std::getline(file, line);) {
        int step, kind, id;
        double x, y;
        if (std::sscanf(line.c_str(), "%d,%d,%d,%lf,%lf", &step, &kind, &id, &x, &y) != 5) continue;
        if (steps.size() <= static_cast<std::size_t>(step)) steps.resize(step + 1);
        if (kind == 1) steps[step].emplace_back(x, y);
    }
    if (steps.empty()) return 3;
    if (steps.size() > most) steps.resize(most);
    const association_t association = std::string(arguments[3]) == "nn" ? NN : NNJPDA;
    if (std::string(arguments[2]) == "ekf") run<EKFilter>(steps, association);
    else run<UKFilter>(steps, association);
}
