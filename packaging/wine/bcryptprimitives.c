// Random numbers as Rust's standard library asks Windows for them, by the function that wine before 9 has in their
// place. `make windows` lays the library beside the program; Windows has its own.

#include <stddef.h>

__declspec(dllimport) unsigned char SystemFunction036(void *buffer, unsigned long length);

__declspec(dllexport) int ProcessPrng(unsigned char *buffer, size_t length) {
    return SystemFunction036(buffer, (unsigned long)length);
}
