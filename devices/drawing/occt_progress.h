#pragma once
// How far OpenCASCADE has come, and that it stops when nobody wants it any more. Private to the sources that compile
// its headers.

#include <Message_ProgressIndicator.hxx>
#include <string>
#include <utility>

#include "devices/drawing/drawing.h"

namespace seamwright::drawing {

inline tl::unexpected<Error> cancelled(const std::string& name) {
    return tl::unexpected(Error{ErrorKind::usage, "cancelled", name, {}, ErrorCode::cancelled});
}

inline void tell(const DrawingOptions& options, double share, const Text& what) {
    if (options.progress) options.progress(share, what);
}

class Watcher : public Message_ProgressIndicator {
  public:
    Watcher(const DrawingOptions& options, double from, double to, Text what)
        : options_(options), from_(from), to_(to), what_(std::move(what)) {}
    Standard_Boolean UserBreak() override { return options_.cancel.stop_requested(); }
    void Show(const Message_ProgressScope& /*scope*/, const Standard_Boolean /*force*/) override {
        tell(options_, from_ + (to_ - from_) * GetPosition(), what_);
    }

  private:
    const DrawingOptions& options_;
    double from_, to_;
    Text what_;
};

}  // namespace seamwright::drawing
