#pragma once
// From what a sensor and a robot give, or from a file, to a capture of a method.

#include <functional>
#include <stop_token>

#include "devices/frame.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/session/session.h"

namespace seamwright {

// A capture and the settings it brings along (a lens learns the image's size from it).
struct TakenCapture {
    CalibrationCapture capture;  // without id
    nlohmann::json settings;
};

// One stand of the robot. `board` is a second image with the laser off where the sensor can do that; nullptr:
// board and stripe are on one image. Error (input): the target is not seen, in words that say what to change.
Expected<TakenCapture> capture_shot(const CalibrationMethod& method, const nlohmann::json& settings,
                                    const SensorSetup& sensor, const Calibration* base, const Frame& stripe,
                                    const Frame* board, const std::optional<Pose>& base_from_flange);

struct ReadCaptures {
    std::vector<CalibrationCapture> captures;
    nlohmann::json settings;
    std::vector<Text> skipped;  // sentences: images without a board
};
// A JSON file as the command line takes it, or, where reads_images(), a folder of images with their pose files.
// Cancelled = Error whose `what` is kCancelled (projects/station/acquire.h).
Expected<ReadCaptures> read_captures(const CalibrationMethod& method, const nlohmann::json& settings,
                                     const Calibration* base, const std::filesystem::path& path,
                                     const ReadProgress& progress, const std::stop_token& cancel);

// Whether a folder of images can be read for it.
bool reads_images(const CalibrationMethod& method);

// What of the target an entry shows, for thumbnails and the coverage of the field. Pixels for images, mm (x,
// z) for profiles.
struct EntryPicture {
    bool pixels = false;
    int width = 0, height = 0;            // of the image; 0 for profiles
    std::vector<Eigen::Vector2d> points;  // all that was seen, thinned
    std::vector<Eigen::Vector2d>
        outline;  // of the target found in it: closed for a board, the arc for a sphere
    std::optional<Eigen::Vector3d> circle;  // of a sphere: x, z of its middle and its radius, mm
};
EntryPicture entry_picture(const CalibrationMethod& method, const nlohmann::json& settings,
                           const nlohmann::json& entry);

}  // namespace seamwright
