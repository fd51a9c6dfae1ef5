#pragma once
// The stripe among its reflections, told by what was taught (methods.md 1 and 2). A reflection may be as smooth as the
// stripe, brighter, and of the stripe's own shape: within a frame nothing may tell it. What was taught does: at the place
// where the part lies nearly all of the taught contour is seen among the candidates, however they were chosen; at the place
// where a reflection would have it, only as much as the reflection is long.

#include <array>

#include "core/features/contour/contour_model.h"
#include "core/features/registration/registration.h"
#include "core/profile/filter.h"

namespace seamwright {

enum class StripeChoice {
    plain,     // no second contour in the frame, or none that the taught one could be taken for
    told,      // a second one, and the taught contour told which is the stripe
    undecided  // at two places the taught contour is seen about equally well
};

// What is said of `undecided`.
inline constexpr const char* kTwoContours =
    "two contours like the taught one are seen, and nothing tells which is the reflection";

// Holds buffers: one thread each. Allocates nothing after its first calls with a second contour in the frame.
class TaughtStripe {
  public:
    // `contour`: the whole tracked profile as taught, not the template alone: its ends are what tells most. `reference_mm`
    // and `window`: where the part may lie, as for ContourMatcher, which says what is refused.
    static Expected<TaughtStripe> make(const Profile& contour, const Eigen::Vector2d& reference_mm,
                                       const SearchWindow& window);

    // track_stripe(), and again with what the taught contour tells where the candidates that it passed over make a contour
    // too. `undecided` leaves the first answer. Units: mm. Error: track_stripe()'s.
    Expected<StripeChoice> track(const ProfileCandidates& candidates, const FilterOptions& options,
                                 Profile& profile);

  private:
    struct Place {  // where the taught contour may lie
        PlanarMotion scene_from_taught;
        bool ambiguous = false;  // the contour fits elsewhere as well
        int lines = 0;           // with a candidate on it
        double seen = 0;         // what speaks for it, in lines and points of the contour inside the field
        std::vector<char> on_contour;  // per slot of a candidate
    };
    TaughtStripe(ContourMatcher matcher, const SearchWindow& window)
        : matcher_(std::move(matcher)), window_(window) {}
    bool second_contour(const ProfileCandidates& candidates, const FilterOptions& options,
                        const Profile& profile);
    double look_for(const Profile& scene);
    void spread(std::vector<float>& quality, std::span<const double> along, double reach);
    void look_at(const ProfileCandidates& candidates, Place& place);
    bool tell(const ProfileCandidates& candidates, const Place& place, const Profile& profile);

    ContourMatcher matcher_;
    ContourModel model_;
    SearchWindow window_;
    ProfileCandidates rest_;
    Profile rival_, both_, told_;
    std::array<Place, 3> places_;
    double noise_mm_ = 0;    // of a point to the contour, where it lies on it
    std::size_t found_ = 0;  // of places_
    // How well an edge of the model, a line of the scene is met: 0..1.
    std::vector<float> of_edge_, of_line_, spread_;
    std::vector<double> along_;
    std::vector<char> shows_;         // per line: the contour
    std::vector<signed char> known_;  // per slot
};

}  // namespace seamwright
