#pragma once
// What the things of an older setup are called today. Evidence is never edited and says the names of its time; a rename
// leaves what it rests on as it was, so that what was proven stands on under the new name.
//
// A thing keeps its name where what it is (spot: type, sensor, robot, taught pose, feature; region: type, spots, free
// directions; sensor and robot: driver and identity) is the same under it. Else it is the one that is the same under a name
// that said something else then. Where there is none, the name means what it meant, changed, unless it was given to a thing
// that had another one: what takes a former name inherits nothing.

#include <optional>
#include <string>

#include "projects/proof/checklist.h"

namespace seamwright {

// Today's names of the things of one setup; nullopt: it is no more. Holds references to both.
class PresentNames {
  public:
    PresentNames(const Project& then, const Project& now);
    std::optional<std::string> spot(const std::string& id) const;
    std::optional<std::string> region(const std::string& id) const;
    std::optional<std::string> sensor(const std::string& id) const;
    std::optional<std::string> robot(const std::string& id) const;

  private:
    const Project &then_, &now_;
    bool devices_kept_, spots_kept_, regions_kept_;
};

// The newest pass of the spot that is called so today; nullptr: none.
const Evidence* newest_pass(const Project& now, const Facts& facts, const std::string& spot_id);
bool is_pass_of(const Project& now, const Facts& facts, const Evidence& evidence, const std::string& spot_id);

// A proof with today's names of its regions. What is no more keeps its name, with a "'" where another region has it.
ZeroShift in_present_names(ZeroShift proof, const Project& then, const Project& now);
KnownShift in_present_names(KnownShift proof, const Project& then, const Project& now);
// The same of the setup that `evidence` refers to; as it is where the facts hold none.
template <class T>
T in_present_names(const Evidence& evidence, const Facts& facts, const Project& now) {
    const auto then = facts.setups.find(evidence.setup);
    const T& proof = std::get<T>(evidence.what);
    return then == facts.setups.end() ? proof : in_present_names(proof, *then->second, now);
}

}  // namespace seamwright
