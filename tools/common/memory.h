// memory.h: how the programs get and keep their memory.
#pragma once

namespace kiln::cli {

/// Lets the program keep the memory that it frees, and share one heap among its threads. A page that comes fresh from the system
/// costs more time than reading 4 KB into it, and states come one after the other. To be called before there are threads.
void set_up_memory();

}  // namespace kiln::cli
