#include "core/error.h"

#include <utility>

namespace seamwright {

SEAM_VALUE_TYPE_MEMBERS(Error)

Error::Error(ErrorKind its_kind, Text its_what, Text its_where, Text its_mend, ErrorCode its_code)
    : kind(its_kind),
      what(std::move(its_what)),
      where(std::move(its_where)),
      mend(std::move(its_mend)),
      code(its_code) {}

Text Error::text() const {
    return joined(joined(where, ": ", what), "; ", mend);
}

std::string Error::sentence() const {
    return text().english();
}

tl::unexpected<Error> input_error(Text what, Text where, Text mend) {
    return tl::unexpected(Error(ErrorKind::input, std::move(what), std::move(where), std::move(mend)));
}

tl::unexpected<Error> usage_error(Text what, Text where, Text mend) {
    return tl::unexpected(Error(ErrorKind::usage, std::move(what), std::move(where), std::move(mend)));
}

tl::unexpected<Error> device_error(Text what, Text where, Text mend) {
    return device_error(ErrorCode::none, std::move(what), std::move(where), std::move(mend));
}

tl::unexpected<Error> device_error(ErrorCode code, Text what, Text where, Text mend) {
    return tl::unexpected(Error(ErrorKind::device, std::move(what), std::move(where), std::move(mend), code));
}

tl::unexpected<Error> file_error(Text what, Text where, Text mend) {
    return tl::unexpected(Error(ErrorKind::file, std::move(what), std::move(where), std::move(mend)));
}

}  // namespace seamwright
