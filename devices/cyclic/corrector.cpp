#include "devices/cyclic/corrector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace seamwright {
namespace {
constexpr std::uint64_t kFarBack = 1000;  // cycles: older than that is no late packet
constexpr int kSuspicion = 5;
constexpr int kOpen = 10;                 // packets without an answer after which the numbers decide
constexpr int kFound = 3;                 // packets of a robot that stands, by what it shows
constexpr std::uint64_t kForgiven = 250;  // good cycles per late one
constexpr double kClearer = 0.5;          // one explanation against the other
constexpr double kStandsMm = 0.5e-3;      // per cycle: no path is so slow
constexpr double kShownStandsMm = 0.01, kShownStandsRad = 1e-4;  // the same of what a servo still makes good
constexpr double kPathBegunMm = 0.5;
constexpr int kStood = 3;  // cycles at its end before a session ends regularly
constexpr double kRounding = 1e-12;
constexpr double kWithin = 0.999;  // of the limit: what rounding and turns about several axes add
constexpr std::uint64_t kLagCycles = 25;

Eigen::Vector3d limited(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double step, bool& settled) {
    const Eigen::Vector3d way = to - from;
    const double length = way.norm();
    if (length <= step * (1 + 1e-9)) return to;
    settled = false;
    return from + way * (step / length);
}
}  // namespace

CyclicCorrector::CyclicCorrector(const CyclicSettings& settings, std::unique_ptr<CyclicProtocol> protocol)
    : settings_(settings),
      cycle_s_(settings.cycle_ms / 1e3),
      step_mm_(kWithin * settings.ramp.speed_mm_s * cycle_s_ / (1 + protocol->unproven())),
      step_rad_(kWithin * rad_from_deg(settings.ramp.speed_deg_s) * cycle_s_ / (1 + protocol->unproven())),
      tolerance_rad_(rad_from_deg(settings.follow_tolerance_deg)),
      protocol_(std::move(protocol)),
      ramp_(
          [&] {
              RampLimits limits = settings.ramp;
              limits.speed_mm_s *= kWithin / (1 + protocol_->unproven());
              limits.speed_deg_s *= kWithin / (1 + protocol_->unproven());
              return limits;
          }(),
          cycle_s_),
      sent_ramp_(ramp_),
      history_(cycle_s_) {}

bool CyclicCorrector::at_zero() const {
    return held_.is_zero() && told_.is_zero() && ramp_.zero() && sent_ramp_.zero() &&
           ramp_.target_is_zero() && sent_ramp_.target_is_zero();
}

void CyclicCorrector::raise(Text reason) {
    if (steering_) steering_->alarmed(reason);
    if (!alarm_) alarm_ = std::move(reason);
    lead_back();
    steady_ = 0;
    revoke();
}

void CyclicCorrector::lead_back() {
    ramp_.set_target(Pose::Identity());
    sent_ramp_.set_target(Pose::Identity());
}

void CyclicCorrector::revoke() {
    unanswered_ = unanswered_ || (permitted_ && protocol_->stops_unanswered());
    permitted_ = false;
    phase_ = PathPhase::none;
}

void CyclicCorrector::path_is_over() {
    phase_ = PathPhase::over;
    permitted_ = false;
}

void CyclicCorrector::withdraw() {
    set_target(Pose::Identity());
    revoke();
}

std::optional<Text> CyclicCorrector::take_alarm() {
    return std::exchange(alarm_, std::nullopt);
}

void CyclicCorrector::set_target(const Pose& displacement) {
    ramp_.set_target(displacement);
    sent_ramp_.set_target(displacement);
    trouble_ = good_ = 0;
    steady_ = 0;
    deviating_ = 0;
    phase_ = PathPhase::none;
}

void CyclicCorrector::await_path() {
    phase_ = PathPhase::waiting;
    permitted_ = true;
    run_before_ = last_.on_path.value_or(false);
    if (last_.programmed) path_begin_ = last_.programmed->translation();
    standing_ = 0;
}

CyclicCorrector::State CyclicCorrector::state() const {
    State s;
    s.packet = last_;
    s.held = held_;
    s.told = told_;
    s.arrived = sent_ramp_.arrived();
    s.zero = held_.is_zero() && told_.is_zero() && sent_ramp_.zero();
    s.silent = silent_;
    s.follows = follows_;
    s.misfit = misfit_;
    s.steady = steady_;
    s.session = counters_.sessions;
    s.path = phase_;
    return s;
}

void CyclicCorrector::silence() {
    if (silent_) return;
    silent_ = true;
    steady_ = 0;
    follows_ = false;
    // A path that stood when its program switched the correction off has ended; what the robot holds when it
    // speaks again is judged then.
    const bool regular =
        phase_ == PathPhase::over ||
        (phase_ == PathPhase::running && (last_.on_path ? !*last_.on_path : standing_ >= kStood));
    if (regular) {
        path_is_over();
        lead_back();
    } else if (!at_zero() && !unanswered_) {
        raise("the robot fell silent under a correction");
    }
    permitted_ = unanswered_ = false;
}

CyclicCorrector::Relation CyclicCorrector::relate(const CyclicPacket& packet, const CyclicArrival& arrival) {
    if (!known_) return Relation::first;
    if (arrival.other_peer) return Relation::jump;
    std::uint64_t ahead = packet.number - last_.number;
    std::uint64_t behind = last_.number - packet.number;
    if (packet.number_wrap > 0) {
        ahead %= packet.number_wrap;
        behind %= packet.number_wrap;
    }
    const std::uint64_t each = std::max<std::uint64_t>(packet.numbers_per_cycle, 1);
    const bool back = packet.number_wrap > 0 ? ahead > behind : packet.number <= last_.number;
    if (packet.number == last_.number || back) {
        if (behind > kFarBack * each) return Relation::jump;
        // A few exchanged ones are let pass; numbers that run on from further back have jumped there.
        running_back_ = packet.number == old_number_ + each ? running_back_ + 1 : 0;
        old_number_ = packet.number;
        if (running_back_ >= settings_.max_late) return Relation::jump;
        return Relation::old;
    }
    cycles_ = std::max<std::uint64_t>(ahead / each, 1);
    const bool quiet = !arrival.gap && !silent_;
    return cycles_ == 1 && quiet ? Relation::next : Relation::gap;
}

// On, zero, or no telling. `unknown` with relation next means: wait for the next packet, unanswered.
CyclicCorrector::Holds CyclicCorrector::judge(const CyclicPacket& packet,
                                              const std::optional<CyclicTold>& shown, Relation relation) {
    const bool late_rose = packet.late && last_.late && *packet.late > *last_.late;
    bool nearer_zero = false, nearer_held = false, clearly_zero = false;
    if (shown && !(held_.is_zero() && told_.is_zero())) {
        history_.add(held_, packet.programmed ? *packet.programmed : Pose::Identity());
        const CyclicTold nothing;
        Misfit on = history_.misfit(*shown, packet, *protocol_);
        const Misfit sent = history_.misfit(*shown, packet, *protocol_, &told_);
        const Misfit zero = history_.misfit(*shown, packet, *protocol_, &nothing);
        history_.take_back();
        const auto size = [&](const Misfit& m) {
            return m.mm / settings_.follow_tolerance_mm + m.rad / tolerance_rad_;
        };
        if (size(sent) < size(on)) on = sent;
        nearer_zero =
            size(zero) < kClearer * size(on) && zero.within(settings_.follow_tolerance_mm, tolerance_rad_);
        nearer_held =
            size(on) < kClearer * size(zero) && on.within(settings_.follow_tolerance_mm, tolerance_rad_);
        clearly_zero = nearer_zero && size(on) > 1;
    }
    if (relation == Relation::next && open_ == 0) {
        // Late answers may be dropped by themselves, and at once.
        if (late_rose && nearer_zero && (followed_ || !clearly_zero)) return Holds::zero;
        if (unanswered_ && not_running_ && nearer_zero) return Holds::zero;
        if (!clearly_zero || !followed_) {
            suspicion_ = 0;
            return Holds::on;
        }
        return not_running_ || ++suspicion_ >= kSuspicion ? Holds::zero : Holds::unknown;
    }
    if (nearer_held) return Holds::on;
    if (nearer_zero && (followed_ || relation == Relation::jump || open_ > 0)) return Holds::zero;
    if (relation != Relation::jump && open_ == 0) return Holds::on;
    if (held_.is_zero() && told_.is_zero()) return Holds::zero;
    // Of a robot that does not show what it holds, nothing may be supposed: it is left alone until it does.
    if (!shown) {
        open_ = std::max(open_, 1);
        return Holds::unknown;
    }
    // A path that moves hides by its lag what the robot holds, until some of its points are known.
    return ++open_ <= kOpen ? Holds::unknown : Holds::zero;
}

void CyclicCorrector::commit(bool taken) {
    if (taken) {
        held_ = told_;
        ramp_ = sent_ramp_;
    } else {
        ramp_.stand();
        sent_ramp_ = ramp_;
        told_ = held_;
    }
}

void CyclicCorrector::drop(const char* reason, bool new_session) {
    if (!at_zero() && phase_ != PathPhase::over && !unanswered_) raise(reason);
    phase_ = phase_ == PathPhase::over ? PathPhase::over : PathPhase::none;
    permitted_ = unanswered_ = false;
    held_ = told_ = {};
    ramp_.reset();
    sent_ramp_.reset();
    history_.clear();
    followed_ = showed_zero_ = false;
    suspicion_ = 0;
    if (new_session) {
        ++counters_.sessions;
        protocol_->new_session();
        trouble_ = good_ = 0;
        steady_ = 0;
    }
}

// A robot that is met for the first time may hold what an earlier program has told it. True: it is not
// answered yet. A moving one, or one that has just come to a stand, shows its servo's lag as well: the motion of as long as any
// lag must be known first.
bool CyclicCorrector::adopt(const CyclicPacket& packet, const std::optional<CyclicTold>& shown,
                            double moved_mm) {
    const auto nothing = [&](const CyclicTold& t) {
        return t.mm.norm() <= settings_.follow_tolerance_mm && t.turn_rad.norm() <= tolerance_rad_;
    };
    if (!shown || nothing(*shown)) return false;
    const bool stands = moved_mm <= kStandsMm && (shown->mm - found_shown_.mm).norm() <= kShownStandsMm &&
                        (shown->turn_rad - found_shown_.turn_rad).norm() <= kShownStandsRad;
    found_shown_ = *shown;
    found_ = stands ? found_ + 1 : 1;
    if (found_ < kFound && !history_.full()) return true;
    const CyclicTold found = history_.without_lag(*shown, packet, *protocol_);
    if (nothing(found) || found.mm.norm() > settings_.max_translation_mm * 1.01 ||
        found.turn_rad.norm() > rad_from_deg(settings_.max_rotation_deg) * 1.01)
        return false;
    restart_from(found);
    followed_ = true;
    raise(
        fmt::format("the robot was found with a correction of {:.3f} mm that was not told it; it is led back",
                    found.mm.norm()));
    return false;
}

void CyclicCorrector::restart_from(const CyclicTold& found) {
    held_ = told_ = found;
    ramp_.reset(protocol_->correction_of(last_, found));
    ramp_.set_target(Pose::Identity());
    sent_ramp_ = ramp_;
    history_.clear();
    if (last_.programmed) history_.add(held_, *last_.programmed);
}

void CyclicCorrector::watch_late(const CyclicPacket& packet, std::uint64_t missed) {
    std::uint64_t newly = 0;
    if (packet.late && last_.late)
        newly = *packet.late > *last_.late   ? *packet.late - *last_.late
                : *packet.late < *last_.late ? *packet.late
                                             : 0;
    counters_.late += newly;
    counters_.missed_cycles += missed;
    const std::uint64_t worse = std::max(newly, missed);
    if (at_zero()) {
        trouble_ = good_ = 0;
        return;
    }
    trouble_ += worse;
    if (worse == 0 && ++good_ >= kForgiven) {
        good_ = 0;
        if (trouble_ > 0) --trouble_;
    }
    if (trouble_ >= static_cast<std::uint64_t>(settings_.max_late))
        raise("too many late or lost packets under a correction");
}

void CyclicCorrector::watch_follow(const std::optional<CyclicTold>& shown) {
    follows_ = false;
    if (last_.programmed) history_.add(held_, *last_.programmed);
    if (!shown) return;
    const CyclicTold nothing;
    const double tolerance_mm = settings_.follow_tolerance_mm;
    misfit_ = history_.misfit(*shown, last_, *protocol_);
    follows_ = misfit_.within(tolerance_mm, tolerance_rad_);
    if (held_.is_zero()) {
        followed_ = false;
        showed_zero_ = showed_zero_ || follows_;
    } else if (follows_ &&
               !history_.misfit(*shown, last_, *protocol_, &nothing).within(tolerance_mm, tolerance_rad_)) {
        followed_ = true;
    }
    // A robot that never showed zero tells something else by these poses; nothing may be corrected then, but
    // it is none of our corrections that is wrong.
    if (follows_ || (at_zero() && !showed_zero_ && !ever_told_)) {
        deviating_ = 0;
        return;
    }
    if (++deviating_ * settings_.cycle_ms < settings_.follow_ms) return;
    deviating_ = 0;
    const CyclicTold found = history_.without_lag(*shown, last_, *protocol_);
    raise(
        fmt::format("the robot does not follow: it shows a correction of {:.3f} mm and {:.3f} degrees where "
                    "it took {:.3f} mm and {:.3f} degrees",
                    found.mm.norm(), deg_from_rad(found.turn_rad.norm()), held_.mm.norm(),
                    deg_from_rad(held_.turn_rad.norm())));
    // A sum goes wrong by what was lost or added twice; what it shows is where it is led back from.
    if (protocol_->incremental()) restart_from(found);
}

void CyclicCorrector::watch_path(const CyclicPacket& packet, double moved_mm) {
    standing_ = moved_mm <= kStandsMm ? standing_ + 1 : 0;
    if (phase_ == PathPhase::waiting) {
        run_before_ = run_before_ && packet.on_path.value_or(false);
        const bool begun =
            packet.on_path
                ? *packet.on_path && !run_before_
                : packet.programmed && (packet.programmed->translation() - path_begin_).norm() > kPathBegunMm;
        if (begun) phase_ = PathPhase::running;
    } else if (phase_ == PathPhase::running && packet.on_path && !*packet.on_path) {
        path_is_over();
    }
}

bool CyclicCorrector::handle(std::span<const std::byte> datagram, const CyclicArrival& arrival) {
    auto parsed = protocol_->parse(datagram);
    if (!parsed) {
        ++counters_.bad;
        return false;
    }
    CyclicPacket& packet = *parsed;
    const Relation relation = relate(packet, arrival);
    if (relation == Relation::old) {
        ++counters_.out_of_order;
        if (++repeated_ == settings_.max_late && !at_zero()) raise("the robot repeats old cycle numbers");
        return true;
    }
    const auto ignored = static_cast<std::uint64_t>(repeated_);
    repeated_ = running_back_ = 0;
    protocol_->follow(packet);
    if (relation == Relation::jump || relation == Relation::first) cycles_ = 1;
    const std::uint64_t missed = cycles_ - 1;
    packet.problem ? ++counters_.bad : ++counters_.packets;

    const std::optional<CyclicTold> shown = packet.problem ? std::nullopt : protocol_->shown(packet);
    double moved_mm = 0;
    if (packet.programmed && last_.programmed)
        moved_mm = (packet.programmed->translation() - last_.programmed->translation()).norm() /
                   static_cast<double>(cycles_);

    if (owed_) commit(false);  // nothing was sent
    owed_ = true;
    // Where the path was before a long pause says nothing of its lag now.
    if (arrival.gap || silent_ || arrival.other_peer || missed > kLagCycles) history_.clear();
    if (relation == Relation::first) {
        known_ = true;
        ++counters_.sessions;
        protocol_->new_session();
    } else {
        // Taken, as far as the count of late answers tells: in a row it falls to the cycles without a packet,
        // as a sum it rises by them.
        const std::uint64_t unanswered = missed + (relation == Relation::jump ? ignored : 0);
        const bool taken = !packet.late || !last_.late || *packet.late <= *last_.late ||
                           *packet.late == unanswered || *packet.late == *last_.late + unanswered;
        // After numbers that jumped it may be the one before. Both lie within a step of each other, so what
        // is told is no further one, until it is known to have been taken.
        pause_ = relation != Relation::next || (pause_ && !taken);
        // A controller that did not take corrections has led the last one out.
        // And one that was not answered may have stopped and begun anew while nobody heard it.
        const bool anew =
            (not_running_ && packet.running) || (protocol_->stops_unanswered() && (arrival.gap || silent_));
        const Relation judged = anew ? Relation::jump : relation;
        switch (judge(packet, shown, judged)) {
            case Holds::on:
                commit(taken);
                if (arrival.other_peer) ++counters_.sessions;
                suspicion_ = open_ = 0;
                break;
            case Holds::zero:
                drop(relation == Relation::next && open_ == 0
                         ? "the robot has dropped the correction by itself"
                         : "the robot began a new session under a correction",
                     relation != Relation::next || open_ > 0);
                open_ = 0;
                break;
            case Holds::unknown:
                commit(taken);
                owed_ = false;
                break;
        }
        watch_late(packet, missed);
    }
    silent_ = false;
    if (packet.problem && !at_zero()) raise(packet.problem);
    if (packet.missing && !at_zero()) raise(fmt::format("the robot's packets carry no {}", packet.missing));
    if (!packet.running && !at_zero()) {
        if (packet.ended && phase_ == PathPhase::running && standing_ >= kStood) {
            path_is_over();
            lead_back();
        } else if (phase_ != PathPhase::over && !unanswered_) {
            raise("the controller left the state in which it takes corrections");
        }
    }
    if (relation == Relation::next && !at_zero() && packet.programmed && last_.programmed &&
        moved_mm > settings_.max_path_speed_mm_s * cycle_s_ * (1 + kRounding))
        raise("the robot's position jumped further than it can move");
    if (not_running_ && packet.running) unanswered_ = false;  // its program has begun anew
    not_running_ = !packet.running;
    // Where the path is; a position that cannot be reached, or none, leaves the one before.
    if (!packet.programmed) packet.programmed = last_.programmed;
    last_ = packet;
    watch_follow(shown);
    if (!looked_) {
        looked_ = !adopt(packet, shown, moved_mm);
        owed_ = owed_ && looked_;
    }
    if (!packet.problem) watch_path(packet, moved_mm);
    if (steering_ && !packet.problem) steering_->see(last_, phase_, arrival.heard_ns);
    if (unanswered_) owed_ = false;
    clean_ = follows_ && missed == 0 && !packet.problem && suspicion_ == 0;
    if (!owed_) {
        commit(false);
        steady_ = 0;
    }
    return true;
}

// Only on the running path: before, the displacement alone is brought on; at its end what is told stays. In the
// correction that is kept of a path that is over, and by whom nobody steers any more, nothing changes by this.
void CyclicCorrector::ask_steering() {
    const auto leave = [&](const Eigen::Vector3d& offset_mm, const Eigen::Vector3d& rate_mm_s) {
        ramp_.steer(offset_mm, rate_mm_s);
        sent_ramp_.steer(offset_mm, rate_mm_s);
    };
    if (phase_ == PathPhase::over) return leave(sent_ramp_.steered_mm(), Eigen::Vector3d::Zero());
    if (phase_ != PathPhase::running) return;
    if (!steering_) return leave(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    PathSteering::Wanted wanted = steering_->wanted(last_, ramp_.steered_mm());
    if (!wanted.offset_mm.allFinite() || !wanted.rate_mm_s.allFinite())
        return raise("what steers the correction told a number that is none");
    if (wanted.alarm) return raise(std::move(*wanted.alarm));
    leave(wanted.offset_mm, wanted.rate_mm_s);
}

std::span<const std::byte> CyclicCorrector::answer() {
    if (!owed_) return {};
    owed_ = false;
    settled_ = true;
    ask_steering();
    sent_ramp_ = ramp_;
    CyclicTold wanted = held_;
    if (pause_) {
        settled_ = false;
    } else if (last_.programmed) {
        CyclicCorrection correction = sent_ramp_.step(last_.programmed->translation());
        const double size = correction.offset_mm.norm();
        if (size > settings_.max_translation_mm) {
            correction.offset_mm *= settings_.max_translation_mm / size;
            raise("the correction left its limit on the way");
        }
        if (const auto told = protocol_->tell(last_, correction)) {
            wanted = *told;
        } else {
            // The robot keeps what it has until it can be told more.
            sent_ramp_ = ramp_;
            settled_ = false;
        }
    }
    told_.mm = limited(held_.mm, wanted.mm, step_mm_, settled_);
    told_.turn_rad = limited(held_.turn_rad, wanted.turn_rad, step_rad_, settled_);
    ever_told_ = ever_told_ || !told_.is_zero();
    steady_ = ramp_.arrived() && sent_ramp_.arrived() && settled_ && clean_ ? steady_ + 1 : 0;
    const bool released = phase_ == PathPhase::waiting || phase_ == PathPhase::running;
    return protocol_->answer(last_, told_, held_, released);
}

}  // namespace seamwright
