#include "devices/drawing/step_text.h"

#include <unistd.h>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>

#include <cstdlib>
#include <filesystem>
#include <mutex>

#include "devices/exchange/files.h"

namespace seamwright::drawing {
namespace {

std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
}

}  // namespace

Quiet::Quiet() {
    one_at_a_time().lock();
    Message::DefaultMessenger()->ChangePrinters().Clear();
}
Quiet::~Quiet() {
    one_at_a_time().unlock();
}

TemporaryFile::TemporaryFile() {
    std::error_code ignored;
    path_ = (std::filesystem::temp_directory_path(ignored) / "seamwright-XXXXXX").string();
    descriptor_ = mkstemp(path_.data());
}
TemporaryFile::~TemporaryFile() {
    if (!ok()) return;
    close(descriptor_);
    unlink(path_.c_str());
}

Expected<std::string> step_text(const std::function<TopoDS_Shape()>& make, const char* unit) {
    const Quiet quiet;
    try {
        const TemporaryFile file;
        if (!file.ok()) return file_error("no file can be made there", file.path());
        STEPControl_Writer writer;
        Interface_Static::SetCVal("write.step.unit", unit);
        Interface_Static::SetCVal("write.step.schema", "AP214IS");
        const TopoDS_Shape shape = make();
        const bool written = !shape.IsNull() &&
                             writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone &&
                             writer.Write(file.path().c_str()) == IFSelect_RetDone;
        Interface_Static::SetCVal("write.step.unit", "MM");
        if (!written) return device_error("OpenCASCADE could not write the shape");
        return read_text_file(file.path(), std::size_t{1} << 30);
    } catch (const Standard_Failure& e) {
        return device_error(Text("OpenCASCADE could not write the shape ({})",
                                 std::string(e.GetMessageString() ? e.GetMessageString() : "")));
    }
}

}  // namespace seamwright::drawing
