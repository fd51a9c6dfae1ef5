#pragma once
// Ids of the things a project names. One type each, so that two of them side by side in a call cannot be swapped: a type
// is made by naming it (SensorId("A")), its text is taken out by naming that too. What is stored or shown is the text.

#include <string>
#include <utility>

namespace seamwright {

template <class Of>
class IdOf {
  public:
    IdOf() = default;  // none
    explicit IdOf(std::string text) : text_(std::move(text)) {}
    const std::string& text() const { return text_; }
    bool empty() const { return text_.empty(); }
    bool operator==(const IdOf&) const = default;

  private:
    std::string text_;
};

using SensorId = IdOf<struct SensorIdTag>;
using RobotId = IdOf<struct RobotIdTag>;
using SpotId = IdOf<struct SpotIdTag>;
using RegionId = IdOf<struct RegionIdTag>;
using MethodId = IdOf<struct MethodIdTag>;            // of a calibration: "tcp-sphere"
using CalibrationId = IdOf<struct CalibrationIdTag>;  // of one that is kept
using PartId = IdOf<struct PartIdTag>;                // a part's number
using PartTypeId = IdOf<struct PartTypeIdTag>;        // its kind

}  // namespace seamwright
