#pragma once
// The answer's report and verdict. Private to core/calibration/on_part.

#include "core/calibration/on_part/advice.h"
#include "core/calibration/on_part/refine.h"

namespace seamwright::on_part {

// What reads the passes by index.
struct Names {
    std::vector<std::string> passes, edges;
    std::vector<bool> excluded;
};

OnPartResult judge(const Refined& refined, const Data& given, const Names& names,
                   const std::vector<Rival>& rivals, const OnPartOptions& options);
// Do the data contradict that the sensor is where the prior says? `refined` by the data alone.
BumpTest bump_of(const Refined& refined, const MountingPrior& prior, const Pose& answer);
// No answer, and why.
OnPartResult refused(const Names& names, OnPartStatus status, const Text& reason, const Text& cure);

}  // namespace seamwright::on_part
