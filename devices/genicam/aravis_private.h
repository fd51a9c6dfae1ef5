#pragma once
// Aravis and GLib, for the .cpp files of this folder only: gio uses names that Qt makes macros of.

#include <arv.h>

#include <memory>
#include <string>

#include "core/error.h"

namespace seamwright {

struct GUnref {
    void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GPtr = std::unique_ptr<T, GUnref>;

// Takes and frees a GError.
class GFailure {
  public:
    GFailure() = default;
    GFailure(const GFailure&) = delete;
    GFailure& operator=(const GFailure&) = delete;
    ~GFailure() { g_clear_error(&error_); }
    GError** out() {
        g_clear_error(&error_);
        return &error_;
    }
    explicit operator bool() const { return error_ != nullptr; }
    bool silent() const {  // nobody answered; further calls wait as long again
        return g_error_matches(error_, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_TIMEOUT) != 0;
    }
    std::string text() const { return error_ ? error_->message : ""; }

  private:
    GError* error_ = nullptr;
};

}  // namespace seamwright
