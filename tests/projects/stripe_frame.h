#pragma once
// A camera's picture of a straight stripe, and of a ghost of it, without any code of the simulation.

#include <algorithm>
#include <cmath>

#include "core/geometry/pose.h"
#include "core/profile/sensor_model.h"
#include "devices/frame.h"

namespace seamwright {

// A camera that looks at the laser plane under 30 degrees from 300 mm.
inline SensorModel stripe_camera() {
    SensorModel model;
    model.camera = {1500, 1500, 319.5, 239.5, 0, 0, 0, 0, 0, 640, 480};
    model.camera_from_laser = make_pose(rotation_exp({rad_from_deg(30) - kPi / 2, 0, 0}), {0, 0, 300});
    return model;
}

// A copy of the stripe, so many rows below it, from a column on.
struct StripeGhost {
    double grey = 0, rows = 60;
    int from = 0;
};

// A stripe on the line from (-40, z) to (end, z + slope) in the sensor frame, and its ghost.
inline void draw_stripe(Frame& frame, const SensorModel& model, double end_mm, double height_mm, double slope,
                        const StripeGhost& ghost = {}) {
    frame.pixels.assign(640 * 480, std::byte{8});
    for (int u = 0; u < 640; ++u) {
        double x = -40;  // the x whose image lies in this column, by bisection
        double low = -60, high = 60;
        for (int i = 0; i < 60; ++i) {
            x = 0.5 * (low + high);
            (model.to_pixel({x, height_mm + slope * x})->x() < u ? low : high) = x;
        }
        if (x > end_mm) continue;
        const double v = model.to_pixel({x, height_mm + slope * x})->y();
        for (int row = 0; row < 480; ++row) {
            double grey = 200 * std::exp(-0.5 * std::pow((row - v) / 2.0, 2));
            if (u >= ghost.from)
                grey += ghost.grey * std::exp(-0.5 * std::pow((row - v - ghost.rows) / 2.0, 2));
            auto& pixel = frame.pixels[static_cast<std::size_t>(row * 640 + u)];
            pixel = static_cast<std::byte>(
                std::min(255, static_cast<int>(pixel) + static_cast<int>(std::lround(grey))));
        }
    }
    frame.image = {frame.pixels.data(), 640, 480, 640, 8};
    frame.profile.clear();
    frame.status = FrameStatus::ok;
}

}  // namespace seamwright
