// Metadata as marker segments.
#pragma once

#include "jpeg/byte_sink.h"
#include "jpeg/metadata.h"

namespace pac::jpeg {

// APP0 [JFIF 1.02 p.5]. Metadata has passed check_metadata().
void write_jfif(const Density& density, ByteSink& sink);
// APP1, APP2 and COM of what is there.
void write_metadata(const Metadata& metadata, ByteSink& sink);

}  // namespace pac::jpeg
