#pragma once
// The cheapest explanation of a sequence of lines with one or several candidates each: the inside of
// filter_profile and track_stripe (not for others).

#include <cstdint>
#include <vector>

#include "core/profile/contour_state.h"

namespace seamwright::contour {

// How a point continues what came before.
enum class Link : std::uint8_t {
    start,   // new segment
    smooth,  // in the band of the prediction
    edge     // within reach, in another direction
};

struct Candidate {
    double x, z;
    double cost;  // of choosing it, beside its position; 0 or more
    int line;     // of the sensor, rising
};

struct Node {
    State state;  // after this point, along its cheapest past
    double cost = 0;
    int previous = -1;
    Link link = Link::start;
    bool calm = false;  // deep in the band of a sharp prediction, right after its predecessor
};

struct Workspace {
    std::vector<Candidate> candidates;  // grouped by line, lines rising
    std::vector<Node> nodes;            // one per candidate
    std::vector<int> first;             // of each line with candidates, and one past the last
    std::vector<int> path;              // candidate numbers of the cheapest sequence, rising
    std::vector<int> longer_path;       // filter: the path with rows taken in
    std::vector<State> backward;        // filter: states seen from the other end, per element of the path
    std::vector<char> wanted;           // filter: of these, which are computed
    std::vector<int> piece;             // filter: per candidate, smooth piece or -1
    std::vector<int> contour_of_piece;  // filter: pieces that only a gap parts have the same
    std::vector<char> vague;            // filter: accepted by vague predictions
    std::vector<int> doubtful;          // filter: the candidates that are
    std::vector<int> chosen;            // tracking: candidate number within the line, or -1
    std::vector<double> enter, leave;  // tracking: per candidate, cost of a new segment that begins or an old
                                       // one that ends there, beside jump_cost; empty: none
    std::vector<double> samples_x, samples_z;
    std::vector<int> pieces;    // filter: segment of a piece
    std::vector<int> segments;  // filter: stack of open segments, three numbers each
};

// Noise and spacing from medians over the candidates `pick`, which rise in line. With `along_path` they are a
// path found before: differences across starts and edges are left out.
Scale estimate_scale(Workspace& w, const std::vector<int>& pick, bool along_path,
                     const FilterOptions& options);

// Fills nodes and path. At most one candidate per line belongs to the path; a line left out costs
// outlier_cost.
void cheapest_sequence(Workspace& w, const Model& model);

// Straight line over the line number through the candidates `points`, which go from an end of the contour inwards: place
// at the first one, advance per line outwards, their covariance, and the age of so many points. Two points at least.
void line_through(const Workspace& w, const int* points, int n, State& state);

// Moves the borders between segments, by up to twelve points, to where the surfaces begin that they part.
// `segment` per line of the sensor, as Profile::segment; the candidates have one per line. Points that both
// sides or neither of them explain stay where they are.
void settle_borders(const Workspace& w, const Model& model, std::vector<std::int32_t>& segment);

}  // namespace seamwright::contour
