#pragma once
// The simulated cell's robot in real time: what an executed robot program (KRL, RAPID, URScript) moves.
//
// Moves are straight lines of the flange, one after the other; translation runs along a trapezoid of speed,
// the rotation in step with it (or sets the pace where it takes longer). A move with `rounding_mm` does not
// stop at its end: the speed is kept into the next one, and the corner is passed exactly. The cell follows
// (SimulatedCell::follow), so whatever exposes sees the robot where it is; where a move ends standing the
// flange has the scatter of an arrival. Standing, the arm may be moved by hand (SimulatedCell::move_to). The
// sensor's trigger input is wired to one digital output: its rising edge fires the sensor at the place where
// the arm then is.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "devices/simulated/cell.h"

namespace seamwright {

struct ArmSettings {
    double acceleration_mm_s2 = 5000;
    double rotation_deg_s = 180;
    double time_scale = 1;   // 2 = twice as fast as real; for tests that ask nothing of time
    int trigger_output = 1;  // wired to the sensor
    bool driven = false;     // time passes by advance() alone, in the cycles of who executes a program
};

// What a program wants done where the path passes a place, on the arm's thread. `at` is exactly that place.
struct PathEvent {
    double before_end_mm = 0;  // along this move; 0 = at its end
    std::function<void(const Pose& at)> act;
};

struct ArmMove {
    Pose base_from_flange = Pose::Identity();
    double speed_mm_s = 250;
    double rounding_mm = 0;  // 0 = stops exactly there
    std::vector<PathEvent> events = {};
};

// Thread-safe. All poses are base_from_flange.
class SimulatedArm {
  public:
    explicit SimulatedArm(std::shared_ptr<SimulatedCell> cell, const ArmSettings& settings = {},
                          const Pose& start = Pose::Identity());
    ~SimulatedArm();

    Pose position() const;                  // as commanded at this instant
    Eigen::Vector3d velocity_mm_s() const;  // of the flange, in base
    // Queues a move behind those under way and returns at once.
    void move(ArmMove move);
    std::size_t pending() const;  // moves not yet at their end
    // Waits until at most `pending` moves are left (a controller's advance run). False when `stop` came
    // first.
    bool wait(std::size_t pending, const std::stop_token& stop) const;
    // Stands at once and forgets the moves that wait.
    void halt();
    // A driven arm's time goes on by that much; events happen on the caller's thread.
    void advance(double seconds);
    // Somebody moved the robot there by other means. Nothing while a move is under way.
    void place(const Pose& base_from_flange);

    void set_output(int number, bool on);
    bool output(int number) const;

  private:
    struct Line;                    // a move with its times
    Pose standing_or_here() const;  // precondition: locked
    void run(const std::stop_token& stop);
    double clock_s() const;  // precondition: locked
    bool tick();             // brings the motion up to the clock; false where none is left

    const std::shared_ptr<SimulatedCell> cell_;
    const ArmSettings settings_;
    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    std::deque<ArmMove> moves_;
    std::unique_ptr<Line> line_;  // under way
    Pose here_;
    Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
    double speed_ = 0;  // carried into the next move
    const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
    double driven_s_ = 0;
    std::optional<double> ended_s_;  // when the last move did: the next one goes on from there
    std::map<int, bool> outputs_;
    std::jthread thread_;  // last
};

}  // namespace seamwright
