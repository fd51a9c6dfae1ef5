#include "core/system_text.h"

#include <cerrno>
#include <string_view>

namespace seamwright {

Text system_text(int number) {
    switch (number) {
        case EPERM:
            return "Operation not permitted";
        case ENOENT:
            return "No such file or directory";
        case EIO:
            return "Input/output error";
        case ENXIO:
            return "No such device or address";
        case EBADF:
            return "Bad file descriptor";
        case ENOMEM:
            return "Cannot allocate memory";
        case EACCES:
            return "Permission denied";
        case EBUSY:
            return "Device or resource busy";
        case EEXIST:
            return "File exists";
        case EXDEV:
            return "Invalid cross-device link";
        case ENODEV:
            return "No such device";
        case ENOTDIR:
            return "Not a directory";
        case EISDIR:
            return "Is a directory";
        case EINVAL:
            return "Invalid argument";
        case EMFILE:
            return "Too many open files";
        case ENFILE:
            return "Too many open files in system";
        case ETXTBSY:
            return "Text file busy";
        case EFBIG:
            return "File too large";
        case ENOSPC:
            return "No space left on device";
        case EROFS:
            return "Read-only file system";
        case EPIPE:
            return "Broken pipe";
        case ENAMETOOLONG:
            return "File name too long";
        case ENOTEMPTY:
            return "Directory not empty";
        case ELOOP:
            return "Too many levels of symbolic links";
        case EDQUOT:
            return "Disk quota exceeded";
        case ESTALE:
            return "Stale file handle";
        case EADDRINUSE:
            return "Address already in use";
        case EADDRNOTAVAIL:
            return "Cannot assign requested address";
        case ENETDOWN:
            return "Network is down";
        case ENETUNREACH:
            return "Network is unreachable";
        case ECONNABORTED:
            return "Software caused connection abort";
        case ECONNRESET:
            return "Connection reset by peer";
        case ENOTCONN:
            return "Transport endpoint is not connected";
        case ETIMEDOUT:
            return "Connection timed out";
        case ECONNREFUSED:
            return "Connection refused";
        case EHOSTDOWN:
            return "Host is down";
        case EHOSTUNREACH:
            return "No route to host";
        default:
            return std::generic_category().message(number);
    }
}

Text system_text(const std::error_code& error) {
    // By name: Boost's categories of the same numbers are others than the standard's.
    const std::string_view category = error.category().name();
    return category == "system" || category == "generic" ? system_text(error.value()) : Text(error.message());
}

}  // namespace seamwright
