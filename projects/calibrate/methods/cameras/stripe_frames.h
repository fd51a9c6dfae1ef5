#pragma once
// Frames of a plate with the stripe across it: what one says is found once (observe()), kept as JSON, and
// solved as often as poses are left out and taken in again.
//
// Data of `calibrate stripe-camera DATA.json`:
//   {"board":{"columns","rows","pitch_mm","pattern"?,"marker_mm"?,"dictionary"?,"legacy"?},
//    "frames":[{"id"?,"size":[w,h],"scan":"rows"|"columns","board":{"pixel":[[u,v],..],"index":[row * columns
//    + column],
//               "symmetry","detector"} or null,"stripe":[[u,v],..],"base_from_flange":POSE or null}]}

#include <filesystem>

#include "core/calibration/stripe/stripe_camera.h"
#include "projects/calibrate/methods/method.h"

namespace seamwright {

nlohmann::json stripe_frame_json(const StripeObservation& observation);
Expected<StripeObservation> parse_stripe_frame(const nlohmann::json& entry, const BoardSpec& spec,
                                               std::size_t index, const std::string& where);
nlohmann::json board_json(const BoardSpec& spec);
Expected<BoardSpec> parse_board_json(const nlohmann::json& value, const std::string& where);

struct StripeData {
    BoardSpec spec;
    std::vector<StripeObservation> observations;
};
Expected<StripeData> parse_stripe_data(const nlohmann::json& data);

// Image and the pose file beside it: the file of the same name, or the one with the same number ("frame0007.png" and
// "pose0007.txt", "images/7.png" and "poses/7.yaml").
Expected<StripeObservation> read_stripe_frame(const std::filesystem::path& image, const BoardSpec& spec);

// A folder of them as data.
Expected<nlohmann::json> stripe_folder_data(const BoardImages& images);

}  // namespace seamwright
