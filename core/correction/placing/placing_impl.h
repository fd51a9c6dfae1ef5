#pragma once
// The information of all candidates at all displacements; inside core/correction/placing alone.

#include "core/correction/placing/placing.h"

namespace seamwright {

struct SpotPlacing::Impl {
    PlacingTask task;
    int dof = 6, size = 6;  // free degrees of D; with what the sensors err by
    int places = 0;
    std::vector<Eigen::Vector3d> references;       // work object, a candidate each
    struct At {                                    // one displacement
        std::vector<Eigen::MatrixXd> information;  // size x size, a candidate each
        Eigen::MatrixXd prior;
        Eigen::MatrixXd bead;  // two rows a point: normal, binormal; dof columns
    };
    std::vector<At> at;

    // Covariance of D's free degrees from the information; false: singular.
    bool invert(const Eigen::MatrixXd& information, Eigen::MatrixXd& covariance) const;
    // Largest variance of the bead; infinite where singular.
    double worst_variance(const At& where, const Eigen::MatrixXd& information) const;
    struct Judged {
        double g = 0, lost = 0;
    };
    // `cutoff`: a g beyond it is enough to know, `lost` is then not looked at.
    Judged judge(std::span<const std::size_t> chosen, double cutoff) const;
    // Smaller is better: g where the wanted holds with one lost, else beyond all of those.
    double cost(const Judged& judged) const;
    void exchange(std::vector<std::size_t>& chosen, double& cost_now) const;
    std::vector<std::size_t> greedy(int k) const;
    bool place_taken(std::span<const std::size_t> chosen, std::size_t candidate, std::size_t but) const;
    PlacedSet placed(std::vector<std::size_t> chosen, bool order) const;
    void shorten(PlacedSet& set) const;
};

}  // namespace seamwright
