/* In place of what Simulink compiles around an S-function: steps of fourth order with the input held at 12 V, for a quarter of a second. */
#include <stdio.h>
#include <string.h>
static void rates(SimStruct *S, const double *x, double *dx) {
    memcpy(S->x, x, sizeof S->x);
    mdlDerivatives(S);
    memcpy(dx, S->dx, sizeof S->dx);
}
int main(void) {
    static SimStruct S;
    double x[64], k[4][64], at[64];
    mdlInitializeSizes(&S);
    mdlInitializeSampleTimes(&S);
    mdlInitializeConditions(&S);
    S.in[0] = 12.0;
    for (int step = 0; step < 10000; step++) {
        memcpy(x, S.x, sizeof x);
        rates(&S, x, k[0]);
        for (int j = 1; j < 4; j++) {
            for (int i = 0; i < 64; i++) at[i] = x[i] + (j == 3 ? 1.0 : 0.5)*2.5e-5*k[j - 1][i];
            rates(&S, at, k[j]);
        }
        for (int i = 0; i < 64; i++) S.x[i] = x[i] + 2.5e-5/6*(k[0][i] + 2*k[1][i] + 2*k[2][i] + k[3][i]);
    }
    mdlOutputs(&S, 0);
    for (int i = 0; i < S.outputs; i++) printf("%.17g\n", S.out[i]);
    mdlTerminate(&S);
    return S.error != NULL;
}
