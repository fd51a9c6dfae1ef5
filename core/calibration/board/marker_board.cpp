#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_detectors.h"
#include "core/calibration/board/board_saddles.h"
#include "core/calibration/camera/camera.h"
#include "core/median.h"

namespace seamwright::detail {
namespace {

constexpr double kLeastMarkerShare = 0.2;  // of the pitch: a marker told smaller was misread
// Of the gap between two tags, clear of edges around a small square's corner.
constexpr double kSmallSquareShare = 0.8;
constexpr double kClearShare = 0.95;  // of the clear space: the window keeps off its rim

using Eigen::Vector2d;
using Corners = std::array<Vector2d, 4>;  // from the marker's top left on, clockwise as it is read

constexpr int kFewestMarkers = 4, kFewestCorners = 6;
constexpr double kConsistentShare = 0.7;  // of the markers, in one homography
constexpr double kStraysBy = 0.5;         // of a marker's edge, from it: a lens bends
constexpr double kUsualMarker = 0.75;     // of the pitch, where its size cannot be told
constexpr double kFarthestMarker = 1.6;   // pitches from a corner to the middle of a marker that predicts it

// The largest of each family: its first markers are those of the smaller ones, with the same numbers.
constexpr std::array kFamilies{
    cv::aruco::DICT_4X4_1000,      cv::aruco::DICT_5X5_1000,       cv::aruco::DICT_6X6_1000,
    cv::aruco::DICT_7X7_1000,      cv::aruco::DICT_ARUCO_ORIGINAL, cv::aruco::DICT_APRILTAG_36h11,
    cv::aruco::DICT_APRILTAG_16h5, cv::aruco::DICT_APRILTAG_25h9,  cv::aruco::DICT_APRILTAG_36h10};

struct Reading {
    int dictionary = kFamilies[0], border_bits = 1;
};

// The squares of a picture, looked for once; which of them are markers, and of which dictionary, is read from their cells.
class Squares {
  public:
    explicit Squares(cv::Mat image) : image_(std::move(image)) {
        auto parameters = cv::aruco::DetectorParameters::create();
        std::vector<int> ids;
        std::vector<std::vector<cv::Point2f>> found;
        cv::aruco::detectMarkers(
            image_, cv::makePtr<cv::aruco::Dictionary>(*cv::aruco::getPredefinedDictionary(kFamilies[0])),
            found, ids, parameters, corners_);
        corners_.insert(corners_.end(), found.begin(), found.end());
    }
    std::size_t size() const { return corners_.size(); }

    std::map<int, Corners> markers(const Reading& reading) const {
        const cv::aruco::Dictionary dictionary = *cv::aruco::getPredefinedDictionary(reading.dictionary);
        std::map<int, Corners> markers;
        std::map<int, int> times;
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            const cv::Mat bits = bits_of(i, dictionary.markerSize, reading.border_bits);
            int id = -1, turns = 0;
            if (bits.empty() || !dictionary.identify(bits, id, turns, kCorrected)) continue;
            ++times[id];
            for (std::size_t k = 0; k < 4; ++k) {
                const cv::Point2f& c = corners_[i][(k + 4 - static_cast<std::size_t>(turns)) % 4];
                markers[id][k] = Vector2d(c.x, c.y);
            }
        }
        for (const auto& [id, n] : times)
            if (n > 1) markers.erase(id);  // which of them is on the board is not known
        return markers;
    }

  private:
    // The cells inside of the border, 1 where they are light; empty where it is no marker's square: without contrast, or its
    // border is not dark.
    cv::Mat bits_of(std::size_t square, int cells, int border) const {
        const int all = cells + 2 * border, side = all * kCell_px;
        const std::vector<cv::Point2f> upright{{0, 0},
                                               {static_cast<float>(side - 1), 0},
                                               {static_cast<float>(side - 1), static_cast<float>(side - 1)},
                                               {0, static_cast<float>(side - 1)}};
        cv::Mat flat, spread, mean;
        cv::warpPerspective(image_, flat, cv::getPerspectiveTransform(corners_[square], upright),
                            {side, side}, cv::INTER_LINEAR);
        cv::meanStdDev(flat(cv::Rect(kCell_px / 2, kCell_px / 2, side - kCell_px, side - kCell_px)), mean,
                       spread);
        if (spread.at<double>(0) < kLeastSpread) return {};
        cv::threshold(flat, flat, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
        cv::Mat bits(cells, cells, CV_8U);
        int light_in_border = 0;
        for (int row = 0; row < all; ++row)
            for (int column = 0; column < all; ++column) {
                const int inner = kCell_px - 2 * kCellRim_px;
                const cv::Mat cell = flat(
                    cv::Rect(column * kCell_px + kCellRim_px, row * kCell_px + kCellRim_px, inner, inner));
                const bool light = 2 * cv::countNonZero(cell) > inner * inner;
                const int r = row - border, c = column - border;
                if (r >= 0 && c >= 0 && r < cells && c < cells)
                    bits.at<std::uint8_t>(r, c) = light;
                else
                    light_in_border += light;
            }
        return light_in_border > kLightBorder * cells * cells ? cv::Mat() : bits;
    }

    static constexpr int kCell_px = 8, kCellRim_px = 2;
    static constexpr double kCorrected = 0.6;     // of the errors that the dictionary can correct
    static constexpr double kLeastSpread = 5;     // of the grey values
    static constexpr double kLightBorder = 0.35;  // light cells of the border, of those inside
    cv::Mat image_;
    std::vector<std::vector<cv::Point2f>> corners_;
};

// Where a marker's middle is, in pitches: x along the columns, y down the rows, from the first marker's or square's middle.
// nullopt: the board has no such marker.
std::optional<Vector2d> middle_of(int id, const BoardSpec& spec, bool legacy) {
    if (id < 0) return std::nullopt;
    if (spec.pattern == BoardPattern::aprilgrid) {
        if (id >= spec.columns * spec.rows) return std::nullopt;
        return Vector2d(id % spec.columns,
                        spec.rows - 1 - id / spec.columns);  // counted from the lowest row up
    }
    // In the light squares, in the order of reading. The first square is dark; before OpenCV 4.6 it was light where the
    // rows are even in number.
    const int first = legacy && spec.rows % 2 == 0 ? 0 : 1;
    int row = 0, before = 0;
    for (; row < spec.rows; ++row) {
        const int offset = (row + first) % 2, in_row = (spec.columns - offset + 1) / 2;
        if (id < before + in_row) return Vector2d(offset + 2 * (id - before), row);
        before += in_row;
    }
    return std::nullopt;
}

struct Seen {
    Corners pixel;
    Vector2d middle;  // pitches
};

Vector2d middle_px(const Corners& c) {
    return 0.25 * (c[0] + c[1] + c[2] + c[3]);
}

double edge_px(const Corners& c) {
    return 0.25 * ((c[1] - c[0]).norm() + (c[2] - c[1]).norm() + (c[3] - c[2]).norm() + (c[0] - c[3]).norm());
}

// Those that lie where the board has them; none when too many do not.
std::vector<Seen> consistent(const std::map<int, Corners>& markers, const BoardSpec& spec, bool legacy) {
    std::vector<Seen> seen;
    for (const auto& [id, corners] : markers)
        if (const auto middle = middle_of(id, spec, legacy)) seen.push_back({corners, *middle});
    if (seen.size() < static_cast<std::size_t>(kFewestMarkers)) return {};
    std::vector<cv::Point2f> board, image;
    double edge = 0;
    for (const Seen& s : seen) {
        const Vector2d p = middle_px(s.pixel);
        board.emplace_back(static_cast<float>(s.middle.x()), static_cast<float>(s.middle.y()));
        image.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
        edge += edge_px(s.pixel) / static_cast<double>(seen.size());
    }
    std::vector<std::uint8_t> fits;
    const cv::Mat h = cv::findHomography(board, image, cv::RANSAC, kStraysBy * edge, fits);
    if (h.empty()) return {};
    std::vector<Seen> good;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (fits[i]) good.push_back(seen[i]);
    // Not on one line, and not mirrored: the plate is seen from its face.
    if (cv::determinant(h(cv::Rect(0, 0, 2, 2))) <= 0) return {};
    const auto enough = static_cast<std::size_t>(
        std::max<double>(kFewestMarkers, std::ceil(kConsistentShare * static_cast<double>(seen.size()))));
    return good.size() >= enough ? good : std::vector<Seen>();
}

struct Read {
    std::vector<Seen> markers;
    bool legacy = false;
};

Read read_board(const Squares& squares, const BoardSpec& spec, const Reading& reading) {
    const auto markers = squares.markers(reading);
    Read best;
    for (const bool legacy : {false, true}) {
        if (legacy && (spec.pattern == BoardPattern::aprilgrid || spec.rows % 2 != 0)) continue;
        if (spec.legacy && *spec.legacy != legacy && spec.rows % 2 == 0) continue;
        auto seen = consistent(markers, spec, legacy);
        if (seen.size() > best.markers.size()) best = {std::move(seen), legacy};
    }
    return best;
}

// As the spec says; where it leaves the dictionary open, every family until one fits, that of the last picture first.
Read read_any(const Squares& squares, const BoardSpec& spec) {
    if (squares.size() < static_cast<std::size_t>(kFewestMarkers)) return {};
    if (spec.pattern == BoardPattern::aprilgrid) {
        for (const int bits : {2, 1})
            if (auto read = read_board(
                    squares, spec,
                    {spec.dictionary >= 0 ? spec.dictionary : int(cv::aruco::DICT_APRILTAG_36h11), bits});
                !read.markers.empty())
                return read;
        return {};
    }
    if (spec.dictionary >= 0) return read_board(squares, spec, {spec.dictionary, 1});
    static thread_local int last = kFamilies[0];
    if (auto read = read_board(squares, spec, {last, 1}); !read.markers.empty()) return read;
    for (const int family : kFamilies) {
        if (family == last) continue;
        auto read = read_board(squares, spec, {family, 1});
        if (read.markers.empty()) continue;
        last = family;
        return read;
    }
    return {};
}

// A marker's edge in pitches: how far its corners stand from its middle, where neighbours' middles are a pitch apart.
double marker_share(const std::vector<Seen>& markers) {
    std::vector<double> shares;
    for (const Seen& m : markers) {
        std::vector<std::pair<double, const Seen*>> near;
        for (const Seen& n : markers)
            if (&n != &m) near.push_back({(n.middle - m.middle).norm(), &n});
        std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        if (near.size() < 3) continue;
        std::vector<Vector2d> board{m.middle}, image{middle_px(m.pixel)};
        for (std::size_t i = 0; i < near.size() && i < 7; ++i) {
            board.push_back(near[i].second->middle);
            image.push_back(middle_px(near[i].second->pixel));
        }
        const auto h = homography_dlt(image, board);
        if (!h) continue;
        for (const Vector2d& c : m.pixel) {
            const Vector2d d = (*h * c.homogeneous()).hnormalized() - m.middle;
            shares.push_back(d.cwiseAbs().sum());
        }
    }
    const double share = shares.empty() ? kUsualMarker : median(shares);
    return share > kLeastMarkerShare && share < 1 ? share : kUsualMarker;
}

// The picture near a place of the board, from the markers around it; nullopt: none is near.
std::optional<Eigen::Matrix3d> homography_near(const std::vector<Seen>& markers, const Vector2d& at,
                                               double marker) {
    constexpr std::size_t kMost = 4;
    std::vector<std::pair<double, const Seen*>> near;
    for (const Seen& m : markers)
        if (const double d = (m.middle - at).norm(); d < kFarthestMarker) near.push_back({d, &m});
    if (near.empty()) return std::nullopt;
    std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (near.size() > kMost) near.resize(kMost);
    std::vector<Vector2d> board, image;
    for (const auto& [d, m] : near)
        for (std::size_t k = 0; k < 4; ++k) {
            const Vector2d out(k == 1 || k == 2 ? 0.5 : -0.5, k >= 2 ? 0.5 : -0.5);
            board.push_back(m->middle + marker * out);
            image.push_back(m->pixel[k]);
        }
    return homography_dlt(board, image);
}

struct Wanted {
    int index;
    Vector2d at;       // pitches, as middle_of()
    bool light_ahead;  // the quarter between +x and +y is light
    double clear;      // pitches around it where nothing else is printed
};

std::vector<Wanted> wanted_corners(const BoardSpec& spec, bool legacy, double marker) {
    std::vector<Wanted> wanted;
    const int columns = board_columns(spec), rows = board_rows(spec);
    const int first = legacy && spec.rows % 2 == 0 ? 0 : 1;
    for (int index = 0; index < columns * rows; ++index) {
        const int column = index % columns, row = index / columns;
        if (spec.pattern == BoardPattern::charuco) {
            wanted.push_back(
                {index, Vector2d(column + 0.5, row + 0.5), (row + column) % 2 == first, 0.5 * (1 - marker)});
            continue;
        }
        // The tag lies towards its middle, the small square away from it.
        const bool right = column % 2, low = row % 2;
        wanted.push_back(
            {index,
             Vector2d(column / 2 + (right ? 0.5 : -0.5) * marker, row / 2 + (low ? 0.5 : -0.5) * marker),
             right != low, kSmallSquareShare * (1 - marker)});
    }
    return wanted;
}

// The corners where the markers say, measured in the picture as taken, `scale` times larger than that which was read.
FoundBoard corners_of(const cv::Mat& full, const Read& read, double scale, const BoardSpec& spec) {
    constexpr int kLeastHalf_px = 3, kMostHalf_px = 12;
    // A corner farther from where the markers say is another thing: half hidden, or a glint.
    constexpr double kAstray_px = 1, kAstray = 0.02;
    constexpr double kLeastPitch_px = 8;  // its marker could not be read
    const double marker = spec.marker_mm > 0 ? spec.marker_mm / spec.pitch_mm : marker_share(read.markers);
    FoundBoard found;
    found.detector = spec.pattern == BoardPattern::aprilgrid ? "AprilGrid"
                     : read.legacy                           ? "ChArUco, legacy"
                                                             : "ChArUco";
    for (const Wanted& w : wanted_corners(spec, read.legacy, marker)) {
        const auto h = homography_near(read.markers, w.at, marker);
        if (!h) continue;
        const auto at = [&](const Vector2d& p) -> Vector2d { return (*h * p.homogeneous()).hnormalized(); };
        const Vector2d place = at(w.at), x = at(w.at + Vector2d(0.25, 0)) - place,
                       y = at(w.at + Vector2d(0, 0.25)) - place;
        const double pitch_px = 4 * std::min(x.norm(), y.norm());
        const int half =
            std::clamp(static_cast<int>(kClearShare * w.clear * pitch_px), kLeastHalf_px, kMostHalf_px);
        if (!place.allFinite() || pitch_px < kLeastPitch_px) continue;
        CornerStart start{place, x.normalized(), y.normalized(), half};
        if (!w.light_ahead) start.first = -y.normalized(), start.second = x.normalized();
        const auto fit = fit_corner(full, start);
        if (!fit || !sound(*fit) ||
            (fit->at - place).norm() > std::max(kAstray_px * scale, kAstray * pitch_px))
            continue;
        found.index.push_back(w.index);
        found.pixel.push_back(fit->at);
        found.object_mm.push_back(board_point(spec, w.index));
    }
    return found;
}

}  // namespace

std::optional<FoundBoard> find_marker_board(const cv::Mat& full, const cv::Mat& grey, const BoardSpec& spec) {
    for (const cv::Mat& small : reduced(grey)) {
        const double scale = static_cast<double>(grey.cols) / small.cols;
        const cv::Mat stripe = stripe_mask(small);
        for (const bool mended : {false, true}) {
            cv::Mat image = small;
            if (mended) {
                cv::Mat wide;
                cv::dilate(stripe, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15}));
                image = stretched(without_stripe(small, stripe), wide, 1.0);
            }
            Read read = read_any(Squares(image), spec);
            if (read.markers.empty()) continue;
            for (Seen& marker : read.markers)
                for (Vector2d& corner : marker.pixel)
                    corner = scale * (corner + Vector2d(0.5, 0.5)) - Vector2d(0.5, 0.5);
            FoundBoard found = corners_of(full, read, scale, spec);
            if (found.pixel.size() >= static_cast<std::size_t>(kFewestCorners)) return found;
        }
    }
    return std::nullopt;
}

}  // namespace seamwright::detail
