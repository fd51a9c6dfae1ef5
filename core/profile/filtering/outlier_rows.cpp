#include <algorithm>
#include <cstddef>
#include <limits>

#include "core/profile/filtering/filter_steps.h"

namespace seamwright::contour {
namespace {

constexpr double kRowShare = 0.5;  // two edges as dear as what a burst pays for one, see take_in_rows

}  // namespace

void take_in_rows(Workspace& w, const Model& m, int lookahead, int min_points) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const double edge_cost = kRowShare * m.edge_cost;
    const int least = std::max(lookahead + 1, min_points);
    auto& longer = w.longer_path;
    bool any = false;
    for (std::size_t k = 0; k + 1 < w.path.size(); ++k) {
        if (any) longer.push_back(w.path[k]);
        const int a = w.path[k], b = w.path[k + 1];
        if (b - a - 1 < least) continue;
        // As it was found, at the prices of here.
        const double old = m.skip(b - a - 1) + (w.nodes[std::size_t(b)].link == Link::smooth ? 0
                                                : w.nodes[std::size_t(b)].link == Link::edge ? edge_cost
                                                                                             : m.jump_cost);
        const Node a_node = w.nodes[std::size_t(a)];
        w.nodes[std::size_t(a)].cost = 0;
        double ended = 0;  // cheapest cost of ending before the present candidate, after...
        int ended_at = a;
        // The cheapest way to candidate c from those before it back to a, into `node`.
        const auto reach = [&](int c, Node& node) {
            const Candidate& point = w.candidates[std::size_t(c)];
            Deviation best_deviation;
            node.cost = infinite;
            const auto put = [&](double cost, int j, Link link) {
                if (!(cost < node.cost)) return false;
                node.cost = cost, node.previous = j, node.link = link;
                return true;
            };
            put(ended + m.jump_cost, ended_at, Link::start);
            for (int j = c - 1; j >= std::max(a, c - m.window); --j) {
                const Node& from = w.nodes[std::size_t(j)];
                const double cost = from.cost + m.skip(c - j - 1);
                const int i = point.line - w.candidates[std::size_t(j)].line;
                if (i > m.longest_gap) break;
                if (from.state.age >= 2) {
                    const Deviation d = deviation(m, from.state, point.x, point.z, i);
                    if (0.5 * d.d2 < m.outlier_cost && put(cost + 0.5 * d.d2, j, Link::smooth))
                        best_deviation = d;
                }
                if (i > m.edge_window) continue;
                const double ratio = reach_ratio(m, from.state, point.x, point.z, i);
                // After a single point any direction goes on.
                const double turn = from.state.age < 2 ? 0 : edge_cost;
                if (ratio < 1) put(cost + turn + kReachCost * m.outlier_cost * ratio * ratio, j, Link::edge);
            }
            const State& from = w.nodes[std::size_t(node.previous)].state;
            const int i = point.line - w.candidates[std::size_t(node.previous)].line;
            node.calm = false;
            node.state = node.link == Link::start ? first_point(m, point.x, point.z) : from;
            if (node.link == Link::smooth) accept(m, node.state, best_deviation, i);
            if (node.link == Link::edge) {
                accept_any_direction(m, node.state, point.x, point.z, i);
                if (from.age < 2) node.link = Link::smooth;
            }
            ended += m.skip_line;
            if (node.cost < ended) ended = node.cost, ended_at = c;
        };
        for (int c = a + 1; c < b; ++c) reach(c, w.nodes[std::size_t(c)]);
        Node last;
        reach(b, last);
        w.nodes[std::size_t(a)] = a_node;
        int taken = 0;
        for (int c = last.previous; c != a; c = w.nodes[std::size_t(c)].previous) ++taken;
        if (!(last.cost < old) || taken < least) continue;
        if (!any) longer.assign(w.path.begin(), w.path.begin() + std::ptrdiff_t(k) + 1);
        any = true;
        longer.resize(longer.size() + std::size_t(taken));
        for (int c = last.previous, at = int(longer.size()) - 1; c != a;
             c = w.nodes[std::size_t(c)].previous, --at)
            longer[std::size_t(at)] = c;
        w.nodes[std::size_t(b)].link = last.link;
        w.nodes[std::size_t(b)].state = last.state;
        w.nodes[std::size_t(b)].calm = false;
        // The states that follow forget where they came from.
        State state = last.state;
        for (std::size_t q = k + 2; q < w.path.size() && q < k + 2 + kWarmUp; ++q) {
            Node& node = w.nodes[std::size_t(w.path[q])];
            const Candidate& point = w.candidates[std::size_t(w.path[q])];
            const int i = line_difference(w, w.path[q - 1], w.path[q]);
            if (node.link != Link::smooth) break;
            if (state.age < 2) {
                accept_any_direction(m, state, point.x, point.z, i);
            } else {
                const Deviation d = deviation(m, state, point.x, point.z, i);
                if (!(0.5 * d.d2 < m.outlier_cost)) break;
                accept(m, state, d, i);
            }
            node.state = state;
            node.calm = false;
        }
    }
    if (!any) return;
    longer.push_back(w.path.back());
    w.path.swap(longer);
}

}  // namespace seamwright::contour
