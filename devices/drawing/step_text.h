#pragma once
// A shape of ours as the text of a STEP file. OpenCASCADE's types: only its wrappers include this.

#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>

#include "core/error.h"

namespace seamwright::drawing {

// `make` may throw what OpenCASCADE throws. `unit` as OpenCASCADE names it: "MM", "M", "INCH", and the shape's numbers are
// in it. Error (device): it could not be made or written.
Expected<std::string> step_text(const std::function<TopoDS_Shape()>& make, const char* unit = "MM");

// OpenCASCADE keeps its settings for the whole program and prints what it thinks: held while it works.
class Quiet {
  public:
    Quiet();
    ~Quiet();
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
};

// A file without name for those of its functions that know files alone; gone with the object.
class TemporaryFile {
  public:
    TemporaryFile();
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    bool ok() const { return descriptor_ >= 0; }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
    int descriptor_ = -1;
};

}  // namespace seamwright::drawing
