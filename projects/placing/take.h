#pragma once
// Proposed spots become the project's: in a region of theirs or in one that is there, with via points over the part, from
// the drawing and not confirmed (confirm.h of projects/confirm). Pure: a project in, a project out; who saves it does so
// in one transaction.
//
// Via points. A plane stands `safe_mm` above the part and above every place that a spot measures at, its normal the mean
// of the spots' height axes. On the way to a spot the sensor rises from the exit of the spot before to the plane and comes
// down to the entry from it, turned as at the spot it leaves or comes to. Between them it goes straight: an obstacle
// beside the part is not known here.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "projects/placing/propose.h"

namespace seamwright {

struct TakeOptions {
    std::string region_id;  // of the project; empty: a new one
    std::string
        new_region;       // its name; empty: "drawing e12", or the first of "drawing e12 2", ... that is free
    std::string frame;    // on the controller, of a new region; empty: made of its name
    double safe_mm = 50;  // 1 to 2000; 0: no via points, straight from exit to entry
};

struct TakenSpots {
    Project project;
    std::string region_id;
    bool new_region = false;
    std::vector<std::string> spot_ids;
};

// `file`: the bytes that the drawing was read from, kept as their length and checksum beside its name. A region keeps its
// spots, the new ones stand behind them. Error (usage): no such region, a name or frame that is taken, both a region and
// a name for a new one, a height out of range; (input): nothing was proposed, or a spot's name is taken meanwhile.
Expected<TakenSpots> take_proposal(const Project& project, const Drawing& drawing,
                                   std::span<const std::byte> file, const Proposal& proposal,
                                   const TakeOptions& options);

// The other way: spots from the drawing that nobody has confirmed leave the project, those of the region or (empty) all,
// and a region that has no other spots with them. Error (usage): no such region; (input): there is no such spot.
Expected<TakenSpots> without_unconfirmed(const Project& project, const std::string& region_id);

}  // namespace seamwright
