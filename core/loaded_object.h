#pragma once
// Shared objects of the house that stand beside the program, each read from disk with the first call that needs it. As libraries
// of the program, what they pull along (OpenCASCADE, VTK's readers, PCL's features, OpenCV's codecs) is most of its start.

#include "core/error.h"

namespace seamwright {

// Where `name`, a function extern "C" of `object` ("seamwright_codecs.so"), begins. To be kept: it is looked up at every call.
// Error (file): the object is not beside the program, is damaged or has no such function.
Expected<void*> loaded_symbol(const char* object, const char* name);

template <class Function>
Expected<Function*> loaded_function(const char* object, const char* name) {
    SEAM_TRY(void* const symbol, loaded_symbol(object, name));
    return reinterpret_cast<Function*>(symbol);
}

}  // namespace seamwright
