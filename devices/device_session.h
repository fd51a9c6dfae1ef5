#pragma once
// What the devices of one cell share.

#include <map>
#include <memory>
#include <string>

#include "core/error.h"

namespace seamwright {

// Sensors and robots that live in one world (a simulation, a recording, one controller connection used by two
// drivers) find it here. Created empty by who opens a cell, and handed to every driver of that cell.
class DeviceSession {
  public:
    // The object stored under `key`, made by `make` at the first call. Drivers of one world agree on the key.
    template <class T, class Make>
    Expected<std::shared_ptr<T>> shared(const std::string& key, Make make) {
        auto it = objects_.find(key);
        if (it == objects_.end()) {
            Expected<std::shared_ptr<T>> made = make();
            if (!made) return made;
            it = objects_.emplace(key, *made).first;
        }
        return std::static_pointer_cast<T>(it->second);
    }

  private:
    std::map<std::string, std::shared_ptr<void>> objects_;
};

}  // namespace seamwright
