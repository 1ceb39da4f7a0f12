/* As much of the header of Simulink as an S-function of continuous states calls, so that the example of docs/bridges.md runs without. */
#include <stddef.h>
typedef double real_T;
typedef int int_T;
typedef struct { real_T x[64], dx[64], in[16], out[64], t; int_T states, inputs, outputs; const char *error; } SimStruct;
#define CONTINUOUS_SAMPLE_TIME 0.0
#define ssSetNumSFcnParams(S, n) ((void)(S))
#define ssSetNumContStates(S, n) ((S)->states = (n))
#define ssSetNumInputPorts(S, n) ((n) == 1)
#define ssSetNumOutputPorts(S, n) ((n) == 1)
#define ssSetInputPortWidth(S, port, n) ((S)->inputs = (n))
#define ssSetInputPortRequiredContiguous(S, port, yes) ((void)(S))
#define ssSetOutputPortWidth(S, port, n) ((S)->outputs = (n))
#define ssSetNumSampleTimes(S, n) ((void)(S))
#define ssSetSampleTime(S, k, time) ((void)(S))
#define ssSetOffsetTime(S, k, time) ((void)(S))
#define ssGetContStates(S) ((S)->x)
#define ssGetdX(S) ((S)->dx)
#define ssGetT(S) ((S)->t)
#define ssGetInputPortRealSignal(S, port) ((const real_T *)(S)->in)
#define ssGetOutputPortRealSignal(S, port) ((S)->out)
#define ssSetErrorStatus(S, text) ((S)->error = (text))
