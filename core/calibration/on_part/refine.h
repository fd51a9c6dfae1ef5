#pragma once
// From a start to the answer: wrong profiles and passes left out, variances estimated, solved again. Not solved: no state
// is possible there, or fewer than half of the profiles agree with it (then the edge that it found is not theirs). Private
// to core/calibration/on_part.

#include "core/calibration/on_part/variances.h"

namespace seamwright::on_part {

struct Refined {
    Data data;  // with those alone used that the answer rests on
    State state;
    Variances variances;
    Estimate estimate;      // from where the state stands
    double cost = 0;        // at these variances, priors in it
    double neighbours = 1;  // see neighbours_factor()
    Eigen::Vector2d working_point = Eigen::Vector2d::Zero();
    std::vector<bool> wrong_passes;
    bool solved = false;
    bool idle_latency = false;  // it was free, nothing shows it, and it is held
};

// `robot`: q is given. Passes of which the others are contradicted are left out whole, a quarter of them at most.
// `straight`: the edges are held so while it is solved; the estimate is the mean over their likely curvatures all the same.
Refined refine(const Data& data, const State& start, const std::optional<RobotRepeatability>& robot,
               bool straight = false);
// Another start on the same profiles at the same variances: its state and cost.
struct Rival {
    State state;
    double cost = 0;
};
Rival rival(const Refined& refined, const State& start);

// The answer by all passes but one: predicted distances of that one's points (mm). Empty: its edge is seen by no other,
// or the rest does not determine the answer. `all`: linearised at the refined state.
std::vector<double> held_out(const Refined& refined, const Blocks& all, std::size_t pass);

}  // namespace seamwright::on_part
