#include "projects/calibrate/target_views.h"

namespace seamwright {

Pose target_from_sensor(const TargetView& view) {
    return make_pose(rotation_exp(view.turn_deg * (kPi / 180)), view.offset_mm);
}

const std::vector<TargetView>& plate_views() {
    static const std::vector<TargetView> views = {
        {{0, 0, 0}, {0, 0, 0}},         {{22, 0, 10}, {0, 8, 6}},     {{-20, 0, -15}, {5, -8, -6}},
        {{0, 22, 30}, {-8, 0, 4}},      {{0, -22, 60}, {8, 4, -5}},   {{16, 16, 90}, {0, 0, 10}},
        {{-16, 16, 120}, {-6, 6, -10}}, {{16, -16, 150}, {6, -6, 8}}, {{-16, -16, 45}, {4, 4, 0}},
        {{25, 8, 75}, {-4, -10, -8}},   {{-25, -8, -60}, {0, 10, 8}}, {{8, 25, -30}, {10, 0, -4}},
        {{-8, -25, 20}, {-10, 0, 0}},   {{12, -4, 180}, {0, 5, 12}},
    };
    return views;
}

const std::vector<TargetView>& sphere_views() {
    static const std::vector<TargetView> views = {
        {{0, 0, 0}, {0, 4, 22}},        {{22, 0, 0}, {0, -5, 20}},       {{-22, 0, 0}, {6, 6, 24}},
        {{0, 20, 0}, {-6, 8, 18}},      {{0, -20, 0}, {4, -8, 22}},      {{0, 0, 45}, {0, 9, 26}},
        {{0, 0, -50}, {-5, -9, 16}},    {{18, 14, 90}, {8, 3, 20}},      {{-18, 14, 130}, {-8, -3, 24}},
        {{18, -14, -100}, {3, 10, 18}}, {{-18, -14, 20}, {-3, -10, 26}}, {{15, 15, 170}, {0, 6, 22}},
    };
    return views;
}

const std::vector<TargetView>& line_views() {
    static const std::vector<TargetView> views = {
        {{0, 0, 5}, {0, 0, -48}},  {{0, 7, 5}, {0, 0, -38}},   {{0, -7, 5}, {0, 0, -30}},
        {{0, 10, 5}, {0, 0, -20}}, {{0, -10, 5}, {0, 0, -10}}, {{0, 0, 5}, {0, 0, 0}},
        {{0, 12, 5}, {0, 0, 8}},   {{0, -12, 5}, {0, 0, 16}},  {{0, 8, 5}, {0, 0, 24}},
        {{0, -8, 5}, {0, 0, 32}},  {{0, 0, 5}, {0, 0, 40}},
    };
    return views;
}

}  // namespace seamwright
