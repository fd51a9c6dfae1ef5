#pragma once
// The evaluation's loops over many trials: on the cell's threads, and in parts of several processes (projects/batch/parts.h).

#include "projects/batch/parts.h"
#include "projects/evaluate/cell.h"

namespace seamwright::evaluation {

// spread_out() of values that depend on nothing but their index; `each(part, i)` hands over the numbers of value i. `profiles` counts
// those of all parts.
template <class Each>
void spread_values(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles, std::size_t count,
                   const std::function<std::function<void(std::size_t)>()>& worker, const Each& each) {
    if (!settings.parts) return spread_out(settings.jobs, count, worker);
    const std::size_t before = profiles;
    const std::vector<std::size_t> mine = settings.parts->begin(count);
    spread_out(mine.empty() ? 1 : settings.jobs, mine.size(), [&] {
        return [&, work = mine.empty() ? std::function<void(std::size_t)>() : worker()](std::size_t k) {
            work(mine[k]);
        };
    });
    profiles = before + settings.parts->end(each, profiles - before);
}

}  // namespace seamwright::evaluation
