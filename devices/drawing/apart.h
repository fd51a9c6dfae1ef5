#pragma once
// A drawing read in a process of its own: OpenCASCADE follows some damaged files into memory that is not there, and what
// it is doing cannot be stopped everywhere. So it ends alone, and the answer is a sentence.

#include <functional>

#include "devices/drawing/drawing.h"

namespace seamwright::drawing {

// `read` runs in a child with options whose progress comes back here; cancelling ends the child, and so does
// options.patience_s (which is set: above 0) without progress. Error besides those of
// `read`: (file) the child ended without an answer or came to no end, (device) no child could be made, (usage) cancelled.
Expected<Drawing> read_apart(const std::string& name, const DrawingOptions& options,
                             const std::function<Expected<Drawing>(const DrawingOptions&)>& read);

}  // namespace seamwright::drawing
