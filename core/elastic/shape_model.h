#pragma once
// The factor analysis behind learn_modes() (modes.h): rows along the directions that they tell, the model
// u = mean + C z with a noise factor for each spot, its fit and its likelihood. Lengths in mm.

#include "core/elastic/modes.h"

namespace seamwright::elastic {

// What one row tells at given noise factors.
struct Told {
    Eigen::MatrixXd m;           // M, r x r
    Eigen::VectorXd heard;       // M y
    double power = 0;            // y^T M y
    Eigen::MatrixXd gain;        // A^-1 H^T: the motions that a shape is taken for; A = G^T L G + P, H = L G
    Eigen::VectorXd still;       // A^-1 G^T L y: the motions that y is taken for
    Eigen::MatrixXd spread;      // A^-1
    double log_determinant = 0;  // of the noise, up to what does not depend on the factors
};

// A row in the r coordinates of `basis` (3 slots x r, orthonormal): products of what each spot measured, so that
// other noise factors cost a sum.
class ShapeRow {
  public:
    ShapeRow(const ElasticRow& row, const Eigen::MatrixXd& basis, int part);

    int part() const { return part_; }
    Eigen::Index spots() const { return static_cast<Eigen::Index>(spots_.size()); }
    // Observed coordinates less free degrees.
    int rank() const;
    // Observed coordinates of the spot, 0: not measured.
    int observed(std::size_t spot) const { return spots_[spot].observed; }
    // The motions are determined.
    bool regular() const;
    // As if the spot had not been measured.
    void leave_out(std::size_t spot) { spots_[spot] = {}; }
    Told told(const Eigen::VectorXd& kappa) const;
    // Adds what is expected of e_n^T L_n e_n, the noise of every spot at its stated sigma, where the row is at u
    // with z spread as `covariance` along `loading`.
    void add_squares(const Told& told, const Eigen::VectorXd& u, const Eigen::MatrixXd& loading,
                     const Eigen::MatrixXd& covariance, Eigen::VectorXd& squares) const;

  private:
    struct Spot {
        int observed = 0;
        Eigen::MatrixXd shape, across,
            motion;                    // of L between shape and shape, shape and motion, motion and motion
        Eigen::VectorXd heard, still;  // of L y
        double power = 0;
    };
    std::vector<Spot> spots_;
    Eigen::Index told_ = 0, motions_ = 0;
    int shared_ = 0, part_ = 0;
};

struct ShapeModel {
    Eigen::VectorXd mean;     // r
    Eigen::MatrixXd loading;  // C, a column a mode
    Eigen::VectorXd kappa;    // of each spot
    double noise_factor = 1;  // of all spots together
};

// Distribution of z of a row: mean and covariance.
struct Latent {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

// M of stated noise, summed over the rows: 3 slots square.
Eigen::MatrixXd stated_information(std::span<const ElasticRow> rows);
// Maximum likelihood; for the factors less the degrees that mean and loading take.
ShapeModel fit_model(std::span<const ShapeRow> rows, Eigen::Index modes);
Latent latent(const Told& row, const ShapeModel& model);
// Log-likelihood of a row up to what does not depend on the model.
double likelihood(const ShapeRow& row, const ShapeModel& model);

}  // namespace seamwright::elastic
