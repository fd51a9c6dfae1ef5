// The kernel of lobe_group.cpp, included once for every instruction set: SEAMWRIGHT_INLINE carries its
// target. (A compiler that splits vectors before it inlines would otherwise do so for the baseline.)

using Reals = float __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));  // also masks: 0 or -1
using Words = std::uint16_t __attribute__((vector_size(16)));

SEAMWRIGHT_INLINE Reals real(float value) {
    return Reals{value, value, value, value, value, value, value, value};
}
SEAMWRIGHT_INLINE Ints whole(int value) {
    return Ints{value, value, value, value, value, value, value, value};
}
SEAMWRIGHT_INLINE Reals least(const Reals& a, const Reals& b) {
    return a < b ? a : b;
}
SEAMWRIGHT_INLINE Reals most(const Reals& a, const Reals& b) {
    return a > b ? a : b;
}
SEAMWRIGHT_INLINE Ints least(const Ints& a, const Ints& b) {
    return a < b ? a : b;
}
SEAMWRIGHT_INLINE Ints most(const Ints& a, const Ints& b) {
    return a > b ? a : b;
}
SEAMWRIGHT_INLINE Reals magnitude(const Reals& a) {
    return most(a, -a);
}
SEAMWRIGHT_INLINE Reals to_real(const Ints& a) {
    return __builtin_convertvector(a, Reals);
}
// Rounds down; what is no row of a window (or not a number) goes to its ends.
SEAMWRIGHT_INLINE Ints to_row(const Reals& a) {
    const Reals positive = a > 0.0f ? a : Reals{};
    return __builtin_convertvector(least(positive, real(2 * kGroupRows)), Ints);
}
SEAMWRIGHT_INLINE bool any(const Ints& mask) {
    std::int64_t part[4];
    std::memcpy(part, &mask, sizeof part);
    return (part[0] | part[1] | part[2] | part[3]) != 0;
}
SEAMWRIGHT_INLINE int lowest(const Ints& a) {
    const Ints fours = least(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3));
    const Ints twos = least(fours, __builtin_shufflevector(fours, fours, 2, 3, 0, 1, 6, 7, 4, 5));
    return least(twos, __builtin_shufflevector(twos, twos, 1, 0, 3, 2, 5, 4, 7, 6))[0];
}
SEAMWRIGHT_INLINE int highest(const Ints& a) {
    return -lowest(-a);
}
template <class Vector, class Scalar>
SEAMWRIGHT_INLINE Vector loaded(const Scalar* from) {
    Vector result;
    std::memcpy(&result, from, sizeof result);
    return result;
}
template <class Vector, class Scalar>
SEAMWRIGHT_INLINE void store(Scalar* to, const Vector& value) {
    std::memcpy(to, &value, sizeof value);
}

// Eight windows side by side, and what is known of the lobe in each of them.
struct Lanes {
    Reals grey[kGroupRows];
    int rows = 0;
    Ints own_rows;  // of the lane's window
    Ints careful;   // lanes given up
    Reals noise, top, base, slope, middle, reach;
    Reals half_left, half_right, width, narrowing;
    Ints top_first, top_last, left, right;

    SEAMWRIGHT_INLINE Reals pick(const Ints& row) const {
        const Ints inside = least(most(row, whole(0)), whole(rows - 1));
#ifdef SEAMWRIGHT_GATHER
        const Ints at = inside * kGroupLanes + Ints{0, 1, 2, 3, 4, 5, 6, 7};
        return SEAMWRIGHT_GATHER(reinterpret_cast<const float*>(grey), at);
#else
        Reals result;
        for (int k = 0; k < kGroupLanes; ++k) result[k] = grey[inside[k]][k];
        return result;
#endif
    }

    // walk() of lobe.h in the lanes of `active`; `high` becomes set where it met a pixel above `limit`. Going
    // right, `tops` counts the pixels of the top's value and `last_top` becomes the last of them.
    template <int Step>
    SEAMWRIGHT_INLINE void walk(const Ints& active, const Ints& from, const Reals& level, const Reals& limit,
                                Ints& last, Ints& high, Ints& tops, Ints& last_top) {
        Ints alive = active, below = whole(0), found = from;
        high = whole(0);
        const int start = Step < 0 ? highest(active ? from : whole(0)) : lowest(active ? from : whole(rows));
        Ints row = whole(start);
        for (int r = start + Step; r >= 0 && r < rows; r += Step) {
            row += Step;
            const Ints passed = Step < 0 ? from > row : from < row;
            const Ints asked = alive & passed;
            const Reals value = grey[r];
            const Ints under = asked & (value < level), above = asked & (value >= level);
            const Ints over = above & (value > limit), taken = above & ~over;
            high |= over;
            alive &= ~((under & below) | over);
            below = under;
            found = taken ? row : found;
            if (Step > 0) {
                const Ints equal = taken & (value == top);
                tops -= equal;
                last_top = equal ? row : last_top;
            }
            if (!any(alive)) break;
        }
        careful |= alive;
        last = active ? found : last;
    }

    SEAMWRIGHT_INLINE void crossing(const Ints& inside, int step, const Reals& level, Reals& at) const {
        const Reals in = pick(inside), out = pick(inside + step);
        const Reals share = least(most((in - level) / (in - out), Reals{}), real(1.0f));
        at = to_real(inside) + static_cast<float>(step) * (in > out ? share : real(0.5f));
    }

    SEAMWRIGHT_INLINE void outline(const Ints& active) {
        const Reals half = 0.5f * (top + base), upper = base + static_cast<float>(kNarrowAt) * (top - base);
        Reals from, to;
        crossing(left, -1, half, from);
        crossing(right, 1, half, to);
        Ints first = top_first, last = top_last;
        const int begin = lowest(active ? left : whole(rows)), end = highest(active ? right : whole(0));
        Ints row = whole(begin);
        for (int r = begin; r <= end; ++r, row += 1) {
            const Ints outside = (row < left) | (row > right) | (grey[r] < upper);
            first = outside ? first : least(first, row);
            last = outside ? last : most(last, row);
        }
        Reals upper_from, upper_to;
        crossing(first, -1, upper, upper_from);
        crossing(last, 1, upper, upper_to);
        half_left = active ? from : half_left;
        half_right = active ? to : half_right;
        width = half_right - half_left;
        middle = 0.5f * (half_left + half_right);
        narrowing = active ? most(Reals{}, width - (upper_to - upper_from)) : narrowing;
    }

    // foot_level() and beyond_flank() of lobe.h: light beyond the flank that ends at `edge`.
    template <int Step>
    SEAMWRIGHT_INLINE void beyond_flank(const Ints& active, const Ints& edge, const Ints& out, Reals& level) {
        const Ints near = edge + Step * out, far = near + Step * (kFootPixels - 1);
        careful |= active & (Step < 0 ? far < 0 : far >= own_rows);
        const Ints asked = active & ~careful;
        const Ints first = Step < 0 ? far : near, last = Step < 0 ? near : far;
        int begin = lowest(asked ? first : whole(rows)), end = highest(asked ? last : whole(-1));
        Reals sum{}, low = real(1e9f), high = real(-1e9f);
        Ints row = whole(begin);
        for (int r = begin; r <= end; ++r, row += 1) {
            const Ints outside = (row < first) | (row > last);
            const Reals value = grey[r];
            sum += outside ? Reals{} : value;
            low = outside ? low : least(low, value);
            high = outside ? high : most(high, value);
        }
        level = (sum - low - high) / static_cast<float>(kFootPixels - 2);
        const Ints valley_asked =
            asked & (level - base >= least(static_cast<float>(kOnBackground) * (top - base), 2.0f * noise));
        if (!any(valley_asked)) return;
        const Ints valley_end = edge + Step * (out + kFootPixels / 2);
        Reals bottom = pick(edge);
        Ints valley = edge;
        begin =
            Step < 0 ? highest(valley_asked ? edge : whole(0)) : lowest(valley_asked ? edge : whole(rows));
        for (int r = begin + Step; r >= 0 && r < rows; r += Step) {
            const Ints inside = Step < 0 ? (edge > r) & (valley_end <= r) : (edge < r) & (valley_end >= r);
            const Ints deeper = inside & (grey[r] < bottom);
            bottom = deeper ? grey[r] : bottom;
            valley = deeper ? whole(r) : valley;
        }
        const Ints is_valley =
            valley_asked & (level - bottom > most(static_cast<float>(kDeepValley) * (top - bottom),
                                                  static_cast<float>(kValleySigmas) * noise));
        level = is_valley ? bottom : level;
        reach = is_valley ? least(reach, magnitude(to_real(valley) - middle)) : reach;
    }

    SEAMWRIGHT_INLINE void find_background(const Ints& active) {
        const Reals far = static_cast<float>(kFlankEnds) * narrowing;
        const Ints down = to_row(far), out = down + 1 - (to_real(down) < far);
        reach = active ? real(static_cast<float>(kUnbounded)) : reach;
        Reals low_left, low_right;
        beyond_flank<-1>(active, left, out, low_left);
        beyond_flank<1>(active, right, out, low_right);
        const Reals low = least(least(low_left, low_right), top);
        const Reals high = least(most(low_left, low_right), top);
        careful |= active & (high - low > static_cast<float>(kBackgroundStep) *
                                              (top - low));  // a step: only what stands above both counts
        base = active ? 0.5f * (low + high) : base;
        const Reals sloping = (low_right - low_left) / to_real(right - left + 2 * out + (kFootPixels - 1));
        slope = active ? (reach > 1e6f ? sloping : Reals{}) : slope;
    }

    SEAMWRIGHT_INLINE void centre_of_gravity(const Ints& active, Reals& position) {
        const Reals half_width = 0.5f * width;
        const Reals radius = most(least(half_width + static_cast<float>(kWindowNarrowings) * narrowing +
                                            static_cast<float>(kWindowMore),
                                        reach),
                                  half_width + 0.5f);
        careful |= active & ((middle - radius < 1.0f) | (middle + radius > to_real(own_rows) - 2.0f));
        Ints moving = active & ~careful;
        position = middle;
        if (!any(moving)) return;
        const Ints first = to_row(middle - radius), last = to_row(middle + radius) + 1;
        const int begin = lowest(moving ? first : whole(rows)), end = highest(moving ? last : whole(0));
        Reals above[kGroupRows];
        Ints row = whole(begin);
        const Reals at_zero = base - slope * middle;  // of the background
        for (int r = begin; r <= end; ++r, row += 1) {
            const Ints outside = (row < first) | (row > last);
            const Reals value = grey[r] - (at_zero + slope * to_real(row));
            above[r] = outside ? Reals{} : value;
        }
        const Reals scale = 1.0f / radius;
        for (int step = 0; step < kWindowSteps; ++step) {
            Reals force{}, stiffness{};
            Reals at = real(static_cast<float>(begin));
            for (int r = begin; r <= end; ++r, at += 1.0f) {
                const Reals u = (at - position) * scale;  // in radii
                const Reals square = u * u;
                const Reals window = most(1.0f - square, Reals{});
                const Reals weighted = above[r] * window;
                force += weighted * window * u;
                stiffness += weighted * (1.0f - 5.0f * square);
            }
            const Ints lost = moving & ~(stiffness > 0.0f);
            position = lost ? middle : position;
            moving &= ~lost;
            const Reals move = radius * force / stiffness;
            const Reals most_move = static_cast<float>(kMostMove) * width;
            position = moving ? position + least(most(move, -most_move), most_move) : position;
            moving &= magnitude(move) >= static_cast<float>(kLeastMove);
            if (!any(moving)) break;
        }
        position = magnitude(position - middle) <= half_width ? position : middle;
    }
};

SEAMWRIGHT_INLINE void measure_lanes(LobeGroup& group) {
    Lanes lanes;
    const int rows = lanes.rows = group.rows;
    for (int r = 0; r < rows; ++r)
        lanes.grey[r] = to_real(__builtin_convertvector(loaded<Words>(group.pixels[r]), Ints));
    const auto length = loaded<Ints>(group.length);
    lanes.own_rows = length + 2 * kGroupMargin;
    lanes.noise = loaded<Reals>(group.noise);
    lanes.base = loaded<Reals>(group.background);
    lanes.careful = whole(0);
    lanes.slope = lanes.half_left = lanes.half_right = lanes.narrowing = Reals{};
    lanes.reach = real(static_cast<float>(kUnbounded));
    const Ints all = whole(-1);

    // The highest pixel of the run and its stretch at half height.
    const int longest = highest(length);
    lanes.top = lanes.grey[kGroupMargin];
    Ints at = whole(kGroupMargin);
    for (int k = 1; k < longest; ++k) {
        const Ints higher = (length > k) & (lanes.grey[kGroupMargin + k] > lanes.top);
        lanes.top = higher ? lanes.grey[kGroupMargin + k] : lanes.top;
        at = higher ? whole(kGroupMargin + k) : at;
    }
    lanes.top_first = lanes.top_last = lanes.left = lanes.right = at;
    Ints tops = whole(1), high_left, high_right;
    const Reals half = 0.5f * (lanes.top + lanes.base);
    lanes.walk<-1>(all, at, half, lanes.top - 1.0f, lanes.left, high_left, tops, lanes.top_last);
    lanes.walk<1>(all, at, half, lanes.top, lanes.right, high_right, tops, lanes.top_last);
    lanes.careful |= high_left | high_right | (tops >= 3) | (lanes.top >= group.full_scale);
    lanes.careful |= (lanes.left < 1) | (lanes.right + 2 > lanes.own_rows) |
                     (lanes.right - lanes.left >= static_cast<int>(kBroad));
    const Ints left = lanes.left, right = lanes.right;
    store(group.left, left);
    store(group.right, right);

    // What lies on either side of it in the run may hold lesser peaks.
    Ints rise_left = whole(0), rise_right = whole(0);
    const Ints run_end = length + kGroupMargin;
    Reals inner = lanes.grey[kGroupMargin];
    for (int r = kGroupMargin; r + 1 < kGroupMargin + longest; ++r) {
        const Reals outer = lanes.grey[r + 1];
        rise_left |= (left > r) & (inner > outer);
        rise_right |= (right <= r) & (run_end > r + 1) & (outer > inner);
        inner = outer;
    }
    rise_left &= left - 1 > kGroupMargin;
    rise_right &= right + 2 < length + kGroupMargin;

    // Background and shape.
    Ints active = ~lanes.careful & (to_real(right - left) <= group.max_width);
    const Ints stretched = active;
    lanes.outline(active);
    for (int round = 0; round < 2 && any(active); ++round) {
        const Reals before = lanes.base;
        lanes.find_background(active);
        active &= ~lanes.careful;
        const Reals moved = magnitude(lanes.base - before), height = lanes.top - lanes.base;
        const Ints changed = active & (moved > static_cast<float>(kMovedMuch) * height);
        if (any(changed)) {
            Ints high, ignored_tops = whole(0), ignored_last = whole(0);
            const Reals level = 0.5f * (lanes.top + lanes.base);
            lanes.walk<-1>(changed, lanes.top_first, level, lanes.top, lanes.left, high, ignored_tops,
                           ignored_last);
            lanes.walk<1>(changed, lanes.top_last, level, lanes.top, lanes.right, high, ignored_tops,
                          ignored_last);
            lanes.careful |= changed & ((lanes.left < 1) | (lanes.right + 2 > lanes.own_rows));
            lanes.outline(changed);
        }
        active &= moved >= static_cast<float>(kStands) * height;
    }
    lanes.careful |= stretched & (lanes.width > static_cast<float>(kBroad));

    const Ints measured = stretched & ~lanes.careful;
    Reals position = lanes.middle;
    if (group.centre_of_gravity) lanes.centre_of_gravity(measured, position);

    // Energy between the half-height points, and how much rises and falls again between them.
    Reals energy{}, variation{};
    const int begin = lowest(measured ? lanes.left : whole(rows)),
              end = highest(measured ? lanes.right : whole(-1));
    Ints row = whole(begin);
    const Reals at_zero = lanes.base - lanes.slope * lanes.middle;
    Reals before = lanes.grey[begin > 0 && begin < rows ? begin - 1 : 0];
    for (int r = begin; r <= end; ++r, row += 1) {
        const Ints beyond = row > lanes.right;
        const Reals grey = lanes.grey[r];
        const Reals value = grey - (at_zero + lanes.slope * to_real(row));
        energy += (row < lanes.left) | beyond ? Reals{} : value;
        variation += (row > lanes.left) & ~beyond ? magnitude(grey - before) : Reals{};
        before = grey;
    }
    const Reals height = lanes.top - lanes.base, pixels = to_real(lanes.right - lanes.left + 1);
    const Reals path = 2.0f * lanes.top - lanes.pick(lanes.left) - lanes.pick(lanes.right);
    const Reals excess =
        most(variation - path - static_cast<float>(kMeanDifference) * lanes.noise * (pixels - 1.0f), Reals{});
    const Reals sharp = lanes.narrowing / (static_cast<float>(kSharpness) * lanes.width);
    Reals strength = energy * height * (0.5f * height) / (0.5f * height + excess);
    strength *= least(most(sharp, real(static_cast<float>(kLeastSharp))), real(1.0f));
    strength = lanes.width < static_cast<float>(kHotPixelWidth)
                   ? static_cast<float>(kHotPixelStrength) * strength
                   : strength;

    const Reals least_energy = group.least_sigmas * lanes.noise;
    Ints peak = measured & ~lanes.careful & (height >= loaded<Reals>(group.least_height));
    peak &= (lanes.width >= group.min_width) & (lanes.width <= group.max_width) & (energy > 0.0f);
    peak &= energy * energy >= least_energy * least_energy * pixels;

    store(group.outcome,
          (lanes.careful & kCareful) | (peak & kPeak) | (rise_left & kLeftMore) | (rise_right & kRightMore));
    store(group.half_from, lanes.left);
    store(group.half_to, lanes.right);
    store(group.top_first, lanes.top_first);
    store(group.top_last, lanes.top_last);
    store(group.top, lanes.top);
    store(group.base, lanes.base);
    store(group.slope, lanes.slope);
    store(group.half_left, lanes.half_left);
    store(group.half_right, lanes.half_right);
    store(group.position, position);
    store(group.strength, strength);
}
