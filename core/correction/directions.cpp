// Naming of unobservable directions for people.

#include <fmt/format.h>

#include <cmath>

#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"

namespace seamwright::correction {
namespace {

using Columns = Eigen::MatrixXd;  // 3 rows

// A rotation that moves the spots by less than this share of what its translation does counts as a
// translation.
constexpr double kTranslationShare = 0.15;
// cos of about 2.5 degrees: closer to an axis of the work object than this is called by the axis.
constexpr double kAlongAxis = 0.999;
constexpr double kWrittenZero = 0.005, kWrittenZeroMm = 0.05;  // below: 0 as it is written, and no "-0.00"
constexpr double kOneDirection = 1e-3;  // singular value of translations that are none of their own
// Of the spread, in a radian: an axis that moves the origin by less runs through it.
constexpr double kThroughOrigin = 0.05;

Eigen::Vector3d tidy(Eigen::Vector3d v) {
    Eigen::Index largest;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0) v = -v;
    for (int i = 0; i < 3; ++i) {
        if (std::abs(v[i]) < kWrittenZero) v[i] = 0;
    }
    return v;
}

// Unit vectors that span the columns of `span` (orthonormal): the axes X, Y, Z as far as they lie in it, then
// the rest.
Columns nice_basis(Columns span) {
    Columns out(3, 0);
    const auto take = [&](const Eigen::Vector3d& v) {
        out.conservativeResize(3, out.cols() + 1);
        out.col(out.cols() - 1) = v.normalized();
    };
    const Eigen::Index wanted = span.cols();
    if (wanted == 3) return Columns(Eigen::Matrix3d::Identity());
    for (int axis = 0; axis < 3 && out.cols() < wanted; ++axis) {
        const Eigen::Vector3d in_span = span * (span.transpose() * Eigen::Vector3d::Unit(axis));
        if (in_span.norm() > kAlongAxis) take(in_span);
    }
    // What the taken ones leave of the span.
    for (Eigen::Index k = 0; k < wanted && out.cols() < wanted; ++k) {
        Columns rest = span;
        if (out.cols() > 0) {
            const Columns taken = singular_values(out).u;
            rest -= taken * (taken.transpose() * span);
        }
        Eigen::Index best;
        rest.colwise().norm().maxCoeff(&best);
        take(rest.col(best));
    }
    return out;
}

std::string axis_words(const Eigen::Vector3d& direction) {
    const Eigen::Vector3d v = tidy(direction);
    for (int i = 0; i < 3; ++i) {
        if (v[i] > kAlongAxis) return std::string(1, "XYZ"[i]);
    }
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z());
}

double no_minus(double v) {
    return std::abs(v) < kWrittenZeroMm ? 0.0 : v;
}

}  // namespace

std::vector<Text> name_directions(const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& xi,
                                  const Eigen::Vector3d& centroid, double spread) {
    std::vector<Text> words;
    if (xi.cols() == 0) return words;
    const Eigen::MatrixXd u = singular_values(xi).u;
    // Combinations ordered by how much rotation they hold; the last ones are translations.
    const SingularValues parts = singular_values(u.bottomRows(3));
    Eigen::Index turning = 0;
    for (Eigen::Index k = 0; k < parts.values.size(); ++k) turning += parts.values[k] > kTranslationShare;
    const Eigen::MatrixXd ordered = u * parts.v;

    Columns pure(3, 0);
    if (turning < u.cols()) {
        const Columns translations = ordered.topRows(3).rightCols(u.cols() - turning);
        const SingularValues svd = singular_values(translations);
        Eigen::Index rank = 0;
        for (Eigen::Index k = 0; k < svd.values.size(); ++k) rank += svd.values[k] > kOneDirection;
        pure = svd.u.leftCols(rank);
        const Columns named = nice_basis(pure);
        for (Eigen::Index k = 0; k < named.cols(); ++k)
            words.push_back(Text("translation along {}", axis_words(named.col(k))));
    }
    if (turning == 0) return words;

    const Columns v = ordered.topRows(3).leftCols(turning);              // motion of the centroid, mm
    const Columns w = ordered.bottomRows(3).leftCols(turning) / spread;  // rad
    const Columns named = nice_basis(singular_values(w).u);
    for (Eigen::Index k = 0; k < named.cols(); ++k) {
        const Eigen::Vector3d axis = tidy(named.col(k)).normalized();
        const Eigen::VectorXd mix = least_squares(w, axis).x;
        const Eigen::Vector3d turn = w * mix;  // about 1 rad about the axis
        Eigen::Vector3d move = v * mix;
        move -= pure * (pure.transpose() * move);
        const double pitch = move.dot(turn) / turn.squaredNorm();  // mm per rad
        const Eigen::Vector3d offset = turn.cross(move) / turn.squaredNorm();
        const Eigen::Vector3d point = centroid + offset;
        // Where the axis lies is worth saying unless it runs through the origin or may be shifted there by
        // one of the unobservable translations.
        Eigen::Vector3d at_origin = move - turn.cross(centroid);
        at_origin -= turn * (at_origin.dot(turn) / turn.squaredNorm());
        at_origin -= pure * (pure.transpose() * at_origin);
        const std::string direction = axis_words(axis);
        Text about = direction[0] == '(' ? Text("the axis {}", direction) : Text(direction);
        if (at_origin.norm() > kThroughOrigin * spread)
            about = Text("{} through ({:.1f}, {:.1f}, {:.1f})", about, no_minus(point.x()),
                         no_minus(point.y()), no_minus(point.z()));
        if (std::abs(pitch) > kTranslationShare * spread)
            words.push_back(
                Text("rotation about {} with {:.1f} mm along it per degree", about, rad_from_deg(pitch)));
        else
            words.push_back(Text("rotation about {}", about));
    }
    return words;
}

}  // namespace seamwright::correction
