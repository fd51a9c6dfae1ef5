#pragma once
// The inside of fit_edges, shared by the sources that make it up: the order of things (edge_fit.cpp), where the part
// stands (edge_place.cpp), how well that is known and what else it may be (edge_state.cpp).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/cloud/edge/cell_ends.h"
#include "core/cloud/edge/edge_equations.h"
#include "core/cloud/edge/edge_fit.h"
#include "core/cloud/edge/sheet_ends.h"

namespace seamwright::edge_fitting {

inline constexpr std::size_t kLeastEnds = 12;
inline constexpr std::size_t kMostCells = 110;  // two nodes each: form_model.h is cubic in them
inline constexpr double kLeastLength_mm = 1e-9;

class EdgeFitter {
  public:
    EdgeFitter(const Cloud& cloud, std::span<const EdgeCurve> edges, const Surface& surface,
               const FitOptions& options)
        : cloud_(cloud), edges_(edges), surface_(surface), options_(options) {}

    Expected<EdgeFit> run();

  private:
    bool stopped() const { return options_.cancelled && options_.cancelled(); }
    bool refuse(FitStatus status, Text reason) {
        out_.fit.status = status;
        out_.fit.reason = std::move(reason);
        return false;
    }

    // Residuals of the rough ends with a pose.
    std::vector<Row> rough_rows(const std::vector<SheetEnd>& ends, const std::vector<EdgeSearch>& searches,
                                const Pose& pose) const;

    struct Rough {
        Pose pose = Pose::Identity();
        Equations end;
    };
    // The gate stays until the ends within it have settled, then falls by itself and not by the residuals: the scan's own
    // border may show as many ends as the part.
    Rough settle(const std::vector<SheetEnd>& ends, const std::vector<EdgeSearch>& searches, Pose pose,
                 double capture) const;

    bool place_roughly(const SheetEnds& found);

    // The cells' ends with a pose; of an edge's two sides the one that shows more of them.
    std::vector<CellEnd> ends_at(const Pose& pose, double window) const;
    static std::vector<Row> rows_of(const std::vector<CellEnd>& ends, const Pose& pose);

    struct Exact {
        Pose pose = Pose::Identity();
        std::vector<CellEnd> ends;
        FitSystem system;
        double gate_mm = 0;
        std::size_t inside(double gate) const {
            return static_cast<std::size_t>(std::count_if(ends.begin(), ends.end(), [&](const CellEnd& e) {
                return std::hypot(e.outward_mm, e.normal_mm) < gate;
            }));
        }
    };
    // From a rough pose. Fewer ends than kLeastEnds: it came to nothing.
    Exact exact(const Pose& rough) const;

    // The largest distance across the edges between two poses of them.
    double across_mm(const Pose& a, const Pose& b) const;

    bool place_exactly();

    // The residuals of the same ends with another pose, to first order in the frame of their cells.
    static void shift_ends(std::vector<CellEnd>& ends, const Pose& from, const Pose& to);

    bool open(const Eigen::MatrixXd& motions);
    bool closed();

    // Variance of one cell beside its neighbours, by second differences along each edge: what bends slowly is form.
    double scatter_mm2(bool outward) const;

    double seen_share(std::size_t ends) const;
    bool state();

    // Another place within the start's tolerance where as many ends lie on the edge as narrowly.
    void look_elsewhere();
    void describe();

    const Cloud& cloud_;
    std::span<const EdgeCurve> edges_;
    const Surface& surface_;
    FitOptions options_;
    double radius_ = 0, noise_ = 0;
    std::vector<Rough> rough_;
    std::vector<Exact> exact_;
    std::vector<CellEnd> ends_;
    std::vector<char> counts_;
    FitSystem system_;
    Matrix6 motion_covariance_ = Matrix6::Zero();
    EdgeFit out_;
};

}  // namespace seamwright::edge_fitting
