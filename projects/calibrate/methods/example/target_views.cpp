#include "projects/calibrate/methods/example/target_views.h"

namespace seamwright {

Pose target_from_sensor(const TargetPlace& view) {
    return make_pose(rotation_exp(view.turn_deg * (kPi / 180)), view.offset_mm);
}

const std::vector<TargetPlace>& plate_views() {
    static const std::vector<TargetPlace> views = {
        {{0, 0, 0}, {0, 0, 0}},        {{22, 0, 10}, {0, 8, 6}},      {{-20, 0, -15}, {6, -4, -6}},
        {{0, 22, 30}, {-8, 0, 2}},     {{0, -22, 60}, {6, 6, 6}},     {{16, 16, 90}, {0, 0, 10}},
        {{-16, 16, 120}, {-6, 4, -8}}, {{16, -16, 150}, {6, -2, 6}},  {{-14, -14, 45}, {2, 0, 14}},
        {{25, 8, 75}, {-4, -8, -8}},   {{-20, -8, -60}, {-8, 6, 12}}, {{8, 25, -30}, {6, -4, -6}},
        {{-8, -25, 20}, {-10, -6, 0}}, {{12, -4, 180}, {0, 4, 12}},
    };
    return views;
}

const std::vector<TargetPlace>& sphere_views() {
    static const std::vector<TargetPlace> views = [] {
        struct Seen {
            Eigen::Vector3d turn_deg, centre_mm;  // of the sphere, sensor frame
        };
        static const std::vector<Seen> seen = {
            {{0, 0, 0}, {0, -4, -22}},          {{22, 0, 0}, {20, 12, -12}},
            {{-22, 0, 0}, {-20, -14, -34}},     {{0, 20, 0}, {16, -16, -36}},
            {{0, -20, 0}, {-18, 15, -8}},       {{0, 0, 45}, {20, -17, -30}},
            {{0, 0, -50}, {-20, 17, -14}},      {{18, 14, 90}, {-16, -12, -38}},
            {{-18, 14, 130}, {18, 12, -10}},    {{18, -14, -100}, {-20, -17, -26}},
            {{-18, -14, 20}, {20, 16, -20}},    {{15, 15, 170}, {0, -13, -40}},
            {{-15, 15, -60}, {0, 13, -4}},      {{12, -18, 60}, {20, -11, -38}},
            {{-12, -18, -130}, {-20, 10, -38}}, {{20, 5, -20}, {-20, -15, -8}},
            {{-20, 5, 110}, {20, 14, -8}},      {{5, -20, -170}, {0, -17, -20}},
        };
        std::vector<TargetPlace> all;
        for (const Seen& s : seen)
            all.push_back({s.turn_deg, -(rotation_exp(s.turn_deg * (kPi / 180)) * s.centre_mm)});
        return all;
    }();
    return views;
}

const std::vector<TargetPlace>& line_views() {
    static const std::vector<TargetPlace> views = {
        {{0, 0, 5}, {0, 0, -48}},  {{0, 7, 5}, {0, 0, -38}},   {{0, -7, 5}, {0, 0, -30}},
        {{0, 10, 5}, {0, 0, -20}}, {{0, -10, 5}, {0, 0, -10}}, {{0, 0, 5}, {0, 0, 0}},
        {{0, 12, 5}, {0, 0, 8}},   {{0, -12, 5}, {0, 0, 16}},  {{0, 8, 5}, {0, 0, 24}},
        {{0, -8, 5}, {0, 0, 32}},  {{0, 0, 5}, {0, 0, 40}},
    };
    return views;
}

const std::vector<TargetPlace>& apex_views() {
    static const std::vector<TargetPlace> views = [] {
        // Of the apex, 30 mm above the plate that the body lies on.
        constexpr double kAcross[] = {-28, -14, 0, 14, 28}, kAlong[] = {-26, -13, 0, 13, 26};
        std::vector<TargetPlace> all;
        const auto add = [&](int i, int k) { all.push_back({{0, 0, 0}, {kAcross[i], 0, 30 + kAlong[k]}}); };
        for (const auto& [i, k] : {std::pair{2, 2},
                                   {0, 0},
                                   {4, 4},
                                   {0, 4},
                                   {4, 0},
                                   {2, 0},
                                   {2, 4},
                                   {0, 2},
                                   {4, 2},
                                   {1, 1},
                                   {3, 3},
                                   {1, 3},
                                   {3, 1}})
            add(i, k);
        for (int i = 0; i < 5; ++i)
            for (int k = 0; k < 5; ++k)
                if ((i + k) % 2 == 1) add(i, k);
        return all;
    }();
    return views;
}

}  // namespace seamwright
