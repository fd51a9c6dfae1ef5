#pragma once
// Results of core as JSON (the contract's fields) and as text for people. Millimetre and degree.

#include <nlohmann/json.hpp>
#include <string>

#include "core/alignment/alignment.h"
#include "core/correction/correction.h"
#include "core/features/feature.h"
#include "core/features/registration/registration.h"
#include "core/panel/panel_fit.h"
#include "core/profile/stripe/stripe_light.h"

namespace seamwright::cli {

nlohmann::json vector_json(const Eigen::Ref<const Eigen::VectorXd>& v);
nlohmann::json matrix_json(const Eigen::Ref<const Eigen::MatrixXd>& m);  // rows

// "X 1234.56 Y ... mm  A ... B ... C ... deg (KUKA A B C)"
std::string pose_text(const Pose& pose);

nlohmann::json light_json(const SeenLight& light);
nlohmann::json correction_json(const RegionCorrection& correction);
// Sigma of the six numbers, a line; and its random and systematic part where something is systematic.
std::string correction_sigma_text(const RegionCorrection& correction);
std::string correction_text(const RegionCorrection& correction);
nlohmann::json plan_json(const RegionPlan& plan);
std::string plan_text(const RegionPlan& plan);
nlohmann::json feature_json(const Feature& feature);
std::string feature_text(const Feature& feature);
nlohmann::json registration_json(const Registration& registration);
std::string registration_text(const Registration& registration);
nlohmann::json alignment_json(const AlignmentResult& alignment);
std::string alignment_text(const AlignmentResult& alignment);
nlohmann::json panel_fit_json(const PanelFit& fit);
std::string panel_fit_text(const PanelFit& fit);

}  // namespace seamwright::cli
