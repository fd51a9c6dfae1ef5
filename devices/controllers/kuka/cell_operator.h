#pragma once
// What both KUKA controllers are: the machine with its programs, the robot, and the operator who selects and
// starts them.

#include <atomic>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "devices/controllers/kuka/robot.h"
#include "devices/robot_program.h"
#include "devices/simulated/controller.h"

namespace seamwright::krl {

struct OperatorSettings {
    std::string address = "127.0.0.1", programs;
    int port = 0, slow_ms = 300, application_wait_ms = 0;
    double time_scale = 1;
};
Expected<OperatorSettings> parse_operator_settings(const nlohmann::json& settings, int port, int least_port);

class KukaCell : public SimulatedController {
  public:
    ~KukaCell() override;
    bool released() const override;
    bool taken() const override;
    std::optional<PartVerdict> verdict() const override;
    std::vector<std::string> messages() const;

  protected:
    KukaCell(std::shared_ptr<SimulatedCell> cell, OperatorSettings settings, bool submit);
    // Loads and starts everything; the constructor has not.
    Expected<void> begin();
    void end();  // first in the destructor of what derives: the threads call into it
    // The cell's program as it is now, on the controller: before a telegram is looked at.
    void refresh();

    const std::shared_ptr<SimulatedCell> cell_;
    const OperatorSettings settings_;
    mutable Machine machine_;
    std::unique_ptr<KukaRobot> robot_;

  private:
    Expected<std::vector<ProgramFile>> files() const;
    Expected<void> load(bool everything);
    void select(const std::string& program);
    void cancel();
    void operate(const std::stop_token& stop);
    void line_calls();
    void keep_frames();
    double number(const char* name, double otherwise) const;

    const bool with_submit_;
    std::mutex operator_mutex_;
    std::string loaded_, selected_;
    std::chrono::steady_clock::time_point halted_since_{};
    std::atomic<bool> program_failed_ = false;
    std::map<std::string, std::string> channels_;
    std::jthread program_, submit_, operator_;
};

}  // namespace seamwright::krl
