MODULE SeamwrightServer
    ! Talks to Seamwright (driver abb-rapid). Load it into a task of its own: Controller configuration, Task
    ! SEAMWRIGHT, Type SemiStatic, Main entry SW_Server, TrustLevel NoSafety. It shares the data below with
    ! Seamwright.mod in T_ROB1. System outputs to configure: sw_doMotorsOn (Motors On State), sw_doEStop
    ! (Emergency Stop), sw_doCycleOn (Cycle On).
    ! Options: 616-1 PC Interface, 623-1 Multitasking.
    PERS num swPartNo;
    PERS bool swWaiting;
    PERS num swTick;
    PERS num swCalls;
    PERS string swPart;
    PERS string swType;
    PERS bool swAsk;
    PERS bool swGo;
    PERS bool swEnded;
    PERS num swFired;
    PERS string swSpotName{64};
    PERS pose swAt{64};
    PERS num swGivenFor;
    PERS bool swGone;
    PERS num swVerdict;
    PERS bool swTeaching;
    PERS bool swMove;
    PERS num swMoveNo;
    PERS pose swMoveTo;
    PERS string swSignature;
    PERS num swCount;

    LOCAL CONST string blanks:="                                                                               ";
    LOCAL VAR socketdev server;
    LOCAL VAR socketdev client;
    LOCAL VAR rawbytes message;
    LOCAL VAR clock unheard;
    LOCAL VAR clock unchecked;
    LOCAL VAR num patience:=0.5;
    LOCAL VAR string line1;
    LOCAL VAR string line2;
    LOCAL VAR string line3;
    LOCAL VAR string staged_name{32};
    LOCAL VAR pose staged{32};
    LOCAL VAR string applied_name{32};
    LOCAL VAR wobjdata before{32};
    LOCAL VAR num staged_count:=0;
    LOCAL VAR num applied:=0;
    LOCAL VAR num told:=0;
    LOCAL VAR num starts:=0;
    LOCAL VAR num calls_told:=0;
    LOCAL VAR num calls_measured:=0;
    LOCAL VAR num measured_part:=0;
    LOCAL VAR bool measuring:=FALSE;

    PROC SW_Server()
        swGone:=TRUE;
        swGivenFor:=0;
        swAsk:=FALSE;
        calls_told:=swCalls;
        calls_measured:=swCalls;
        WHILE TRUE DO
            Listen;
            SocketClose client;
            SocketClose server;
            WaitTime 1;
        ENDWHILE
    ENDPROC

    LOCAL PROC Listen()
        SocketClose client;
        SocketClose server;
        SocketCreate server;
        SocketBind server,"@ADDRESS@",@PORT@;
        SocketListen server;
        WHILE TRUE DO
            SocketAccept server,client\Time:=WAIT_MAX;
            staged_count:=0;
            starts:=0;
            measuring:=FALSE;
            ! A call that nobody has answered by measuring is told again.
            IF swWaiting AND swCalls<>calls_measured THEN
                calls_told:=-1;
            ELSE
                calls_told:=swCalls;
            ENDIF
            Serve;
            ! The connection is lost: nothing that it wrote may be used, unless the application has taken it.
            Take_back;
            staged_count:=0;
            swAsk:=FALSE;
            SocketClose client;
        ENDWHILE
    ERROR
        ! The sockets are made anew.
        Take_back;
        RETURN;
    ENDPROC

    ! Until the connection is lost.
    LOCAL PROC Serve()
        VAR bool came;
        Heard;
        WHILE TRUE DO
            came:=FALSE;
            IF SocketPeek(client)>=240 THEN
                came:=Line_came(1);
            ELSE
                TellEvents;
                ! That the other side is gone is told by reading only.
                IF ClkRead(unchecked)>patience THEN
                    came:=Line_came(0.02);
                    Checked 0.5;
                ENDIF
                ! Who is given the permission must be heard until it is taken.
                IF ClkRead(unheard)>5 THEN
                    IF swGivenFor<>0 AND swGone=FALSE RETURN;
                ENDIF
            ENDIF
            IF came THEN
                SocketReceive client\Str:=line2\ReadNoOfBytes:=80\Time:=1;
                SocketReceive client\Str:=line3\ReadNoOfBytes:=80\Time:=1;
                Heard;
                Answer;
            ELSE
                WaitTime 0.002;
            ENDIF
        ENDWHILE
    ERROR
        ! closed, half a message, or what cannot be read
        RETURN;
    ENDPROC

    LOCAL FUNC bool Line_came(num seconds)
        SocketReceive client\Str:=line1\ReadNoOfBytes:=80\Time:=seconds;
        RETURN TRUE;
    ERROR
        IF ERRNO=ERR_SOCK_TIMEOUT RETURN FALSE;
        RAISE;
    ENDFUNC

    LOCAL PROC Heard()
        ClkStop unheard;
        ClkReset unheard;
        ClkStart unheard;
        Checked 0.15;
    ENDPROC

    LOCAL PROC Checked(num next)
        patience:=next;
        ClkStop unchecked;
        ClkReset unchecked;
        ClkStart unchecked;
    ENDPROC

    ! The permission goes, unless the application has it already.
    LOCAL PROC Take_back()
        IF TestAndSet(swGone) THEN
            swGivenFor:=0;
            ! What was set for a permission that nobody has taken is not left standing.
            Undo_applied;
        ENDIF
    ENDPROC

    ! In the order in which it happened: triggers, the end, and only then the call for the next part.
    LOCAL PROC TellEvents()
        VAR bool ended;
        VAR num calls;
        ! Looked at before the end: whoever calls for the next part has ended the one before.
        calls:=swCalls;
        IF swGivenFor<>0 AND swGivenFor<>swPartNo Take_back;
        IF measuring THEN
            ended:=swEnded;
            IF swPartNo<>measured_part ended:=TRUE;
            WHILE told<swFired DO
                told:=told+1;
                SayPose "0 TRIGGER "+NumToStr(told,0)+" "+NumToStr(told,0)+" "+swSpotName{told},swAt{told};
            ENDWHILE
            IF ended THEN
                measuring:=FALSE;
                Say "0 END "+NumToStr(told,0),"","";
            ENDIF
        ENDIF
        IF calls<>calls_told THEN
            starts:=starts+1;
            Say "0 START "+NumToStr(starts,0),swPart,swType;
            calls_told:=calls;
        ENDIF
    ERROR
        RAISE;
    ENDPROC

    LOCAL PROC Answer()
        VAR string number;
        VAR string word;
        VAR string name;
        VAR string head;
        VAR robtarget at;
        VAR pose frame;
        VAR wobjdata object;
        number:=Field(line1,1);
        word:=Field(line1,2);
        name:=Field(line1,3);
        IF StrLen(number)>8 number:="0";
        IF StrLen(word)>16 word:="?";
        IF StrLen(name)>32 name:="?";
        head:=number+" "+word;
        TEST word
        CASE "HELLO":
            Say head+" 2",GetSysInfo(\SerialNo),GetSysInfo(\RobotType);
        CASE "MODE":
            Say head+" "+ModeWords(),"","";
        CASE "PING":
            Say head,"","";
        CASE "POSE":
            at:=CRobT(\TaskName:="T_ROB1"\Tool:=tool0\WObj:=wobj0);
            frame.trans:=at.trans;
            frame.rot:=at.rot;
            SayPose head,frame;
        CASE "READ":
            IF Staged_index(name)>0 THEN
                SayPose head+" "+name,staged{Staged_index(name)};
            ELSEIF Known(name,object) THEN
                SayPose head+" "+name,PoseMult(object.uframe,object.oframe);
            ELSE
                Say number+" NO READ","there is no fixed work object "+name,"";
            ENDIF
        CASE "WRITE":
            Take_back;
            IF NOT Known(name,object) THEN
                Say number+" NO WRITE","there is no fixed work object "+name,"";
            ELSEIF NOT ReadPose(frame) THEN
                Say number+" NO WRITE","the pose cannot be read","";
            ELSEIF Staged_index(name)=0 AND staged_count>=32 THEN
                Say number+" NO WRITE","more than 32 frames","";
            ELSE
                IF Staged_index(name)=0 THEN
                    staged_count:=staged_count+1;
                    staged_name{staged_count}:=name;
                ENDIF
                staged{Staged_index(name)}:=frame;
                SayPose head+" "+name,frame;
            ENDIF
        CASE "MEASURE":
            Measure number,name,Field(line1,4);
        CASE "VERDICT":
            Verdict number,name,Field(line1,4);
        CASE "PERMIT":
            IF swGivenFor=0 THEN
                Say head+" NONE","","";
            ELSEIF swGone THEN
                Say head+" TAKEN","","";
            ELSE
                Say head+" GIVEN","","";
            ENDIF
        CASE "MOVE":
            Move number;
        DEFAULT:
            Say number+" NO "+word,"unknown request","";
        ENDTEST
    ERROR
        RAISE;
    ENDPROC

    LOCAL PROC Measure(string number,string count,string signature)
        Take_back;
        IF count<>NumToStr(swCount,0) OR signature<>swSignature THEN
            Say number+" NO MEASURE","another measuring program is loaded than the project's","";
            RETURN;
        ENDIF
        IF ModeWords()<>"AUTO ON RUN" AND ModeWords()<>"MANR ON RUN" AND ModeWords()<>"MANF ON RUN" THEN
            Say number+" NO MEASURE","the robot is stopped","";
            RETURN;
        ENDIF
        IF measuring AND swEnded=FALSE THEN
            Say number+" NO MEASURE","the measuring program runs already","";
            RETURN;
        ENDIF
        swAsk:=TRUE;
        IF Program_waits() THEN
            ! What the permission was given for is over.
            swGone:=TRUE;
            swGivenFor:=0;
            staged_count:=0;
            applied:=0;
            told:=0;
            swFired:=0;
            swEnded:=FALSE;
            swVerdict:=0;
            measured_part:=swPartNo;
            calls_measured:=swCalls;
            measuring:=TRUE;
            swAsk:=FALSE;
            swGo:=TRUE;
            Say number+" MEASURE "+count,"","";
        ELSE
            swAsk:=FALSE;
            Say number+" NO MEASURE","no program of the robot waits in SW_Measure","";
        ENDIF
    ERROR
        RAISE;
    ENDPROC

    ! Within 0.2 s: it counts while it waits.
    LOCAL FUNC bool Program_waits()
        VAR num tick;
        VAR num waited:=0;
        VAR bool watched:=FALSE;
        WHILE waited<0.2 DO
            IF NOT swWaiting THEN
                watched:=FALSE;
            ELSEIF NOT watched THEN
                watched:=TRUE;
                tick:=swTick;
            ELSEIF swTick<>tick THEN
                RETURN TRUE;
            ENDIF
            WaitTime 0.004;
            waited:=waited+0.004;
        ENDWHILE
        RETURN FALSE;
    ENDFUNC

    ! `count`: how many frames the computer has written for this part; a computer of before it tells none.
    LOCAL PROC Verdict(string number,string word,string count)
        Take_back;
        IF swGivenFor<>0 AND swGivenFor=swPartNo THEN
            Say number+" NO VERDICT","the application has taken the permission already","";
            RETURN;
        ENDIF
        TEST word
        CASE "CORRECTED":
            IF measured_part<>0 AND measured_part<>swPartNo THEN
                Say number+" NO VERDICT","the robot has begun another part","";
            ELSEIF count<>"" AND count<>NumToStr(staged_count,0) THEN
                ! A connection that was lost, or a verdict, has taken some away: the work objects are as before.
                Say number+" NO VERDICT","the frames that were written are gone: measure the part again","";
            ELSEIF NOT Applied_all() THEN
                Say number+" NO VERDICT","a work object cannot be set: "+staged_name{applied+1},"";
                Undo_applied;
            ELSE
                staged_count:=0;
                swVerdict:=1;
                swGivenFor:=swPartNo;
                swGone:=FALSE;
                Say number+" VERDICT "+word,"","";
            ENDIF
        CASE "REFUSED","FAILED":
            staged_count:=0;
            IF word="REFUSED" THEN
                swVerdict:=2;
            ELSE
                swVerdict:=3;
            ENDIF
            Say number+" VERDICT "+word,"","";
        DEFAULT:
            Say number+" NO VERDICT","unknown verdict","";
        ENDTEST
    ERROR
        RAISE;
    ENDPROC

    ! Puts the staged frames into their work objects.
    LOCAL FUNC bool Applied_all()
        VAR wobjdata object;
        applied:=0;
        WHILE applied<staged_count DO
            GetDataVal staged_name{applied+1}\TaskName:="T_ROB1",object;
            before{applied+1}:=object;
            object.uframe:=[[0,0,0],[1,0,0,0]];
            object.oframe:=staged{applied+1};
            SetDataVal staged_name{applied+1}\TaskName:="T_ROB1",object;
            applied:=applied+1;
            applied_name{applied}:=staged_name{applied};
            GetDataVal applied_name{applied}\TaskName:="T_ROB1",object;
            IF NOT Same(PoseMult(object.uframe,object.oframe),staged{applied}) THEN
                SetDataVal applied_name{applied}\TaskName:="T_ROB1",before{applied};
                applied:=applied-1;
                RETURN FALSE;
            ENDIF
        ENDWHILE
        RETURN TRUE;
    ERROR
        RETURN FALSE;
    ENDFUNC

    LOCAL FUNC bool Same(pose a,pose b)
        VAR num turned;
        turned:=Abs(a.rot.q1-b.rot.q1)+Abs(a.rot.q2-b.rot.q2)+Abs(a.rot.q3-b.rot.q3)+Abs(a.rot.q4-b.rot.q4);
        RETURN Distance(a.trans,b.trans)<0.001 AND turned<0.00001;
    ENDFUNC

    LOCAL PROC Undo_applied()
        VAR num i;
        i:=applied;
        applied:=0;
        WHILE i>0 DO
            SetDataVal applied_name{i}\TaskName:="T_ROB1",before{i};
            i:=i-1;
        ENDWHILE
    ERROR
        TRYNEXT;
    ENDPROC

    LOCAL PROC Move(string number)
        VAR pose goal;
        IF OpMode()=OP_AUTO OR swTeaching=FALSE THEN
            Say number+" NO MOVE","moving by command wants manual mode and SW_Teach running","";
        ELSEIF NOT ReadPose(goal) THEN
            Say number+" NO MOVE","the pose cannot be read","";
        ELSE
            swMoveTo:=goal;
            swMoveNo:=(swMoveNo MOD 8000000)+1;
            swMove:=TRUE;
            WHILE swMove AND DOutput(sw_doMotorsOn)=1 AND DOutput(sw_doCycleOn)=1 DO
                WaitTime 0.01;
            ENDWHILE
            IF swMove THEN
                swMove:=FALSE;
                Say number+" NO MOVE","the robot was stopped","";
            ELSE
                Say number+" MOVE","","";
            ENDIF
        ENDIF
    ERROR
        RAISE;
    ENDPROC

    LOCAL FUNC string ModeWords()
        VAR string words;
        TEST OpMode()
        CASE OP_AUTO:
            words:="AUTO";
        CASE OP_MAN_PROG:
            words:="MANR";
        CASE OP_MAN_TEST:
            words:="MANF";
        DEFAULT:
            words:="UNDEF";
        ENDTEST
        IF DOutput(sw_doEStop)=1 THEN
            words:=words+" ESTOP";
        ELSEIF DOutput(sw_doMotorsOn)=1 THEN
            words:=words+" ON";
        ELSE
            words:=words+" OFF";
        ENDIF
        IF DOutput(sw_doCycleOn)=1 RETURN words+" RUN";
        RETURN words+" HALT";
    ENDFUNC

    ! The n-th word of a line, counted from 1; "" where there is none.
    LOCAL FUNC string Field(string line,num n)
        VAR num at:=1;
        VAR num blank;
        VAR num i:=1;
        WHILE at<=StrLen(line) DO
            blank:=StrFind(line,at," \0A");
            IF blank=at RETURN "";
            IF i=n RETURN StrPart(line,at,blank-at);
            at:=blank+1;
            i:=i+1;
        ENDWHILE
        RETURN "";
    ENDFUNC

    LOCAL FUNC bool ReadPose(INOUT pose frame)
        VAR bool ok;
        VAR bool part;
        VAR num size;
        ok:=StrToVal(Field(line2,1),frame.trans.x);
        part:=StrToVal(Field(line2,2),frame.trans.y);
        ok:=ok AND part;
        part:=StrToVal(Field(line2,3),frame.trans.z);
        ok:=ok AND part;
        part:=StrToVal(Field(line3,1),frame.rot.q1);
        ok:=ok AND part;
        part:=StrToVal(Field(line3,2),frame.rot.q2);
        ok:=ok AND part;
        part:=StrToVal(Field(line3,3),frame.rot.q3);
        ok:=ok AND part;
        part:=StrToVal(Field(line3,4),frame.rot.q4);
        ok:=ok AND part;
        IF NOT ok RETURN FALSE;
        IF Abs(frame.trans.x)>100000 OR Abs(frame.trans.y)>100000 OR Abs(frame.trans.z)>100000 RETURN FALSE;
        size:=frame.rot.q1*frame.rot.q1+frame.rot.q2*frame.rot.q2;
        size:=size+frame.rot.q3*frame.rot.q3+frame.rot.q4*frame.rot.q4;
        IF Abs(size-1)>0.002 RETURN FALSE;
        frame.rot:=NOrient(frame.rot);
        RETURN TRUE;
    ENDFUNC

    LOCAL FUNC num Staged_index(string name)
        VAR num i:=1;
        WHILE i<=staged_count DO
            IF staged_name{i}=name RETURN i;
            i:=i+1;
        ENDWHILE
        RETURN 0;
    ENDFUNC

    LOCAL FUNC bool Known(string name,INOUT wobjdata object)
        IF name="" RETURN FALSE;
        GetDataVal name\TaskName:="T_ROB1",object;
        ! One that a robot holds or an axis moves is no frame in the base.
        RETURN object.robhold=FALSE AND object.ufprog;
    ERROR
        RETURN FALSE;
    ENDFUNC

    ! A line is 79 characters and a line feed.
    LOCAL PROC Add_line(string text)
        VAR string line;
        line:=text;
        IF StrLen(line)>79 line:=StrPart(line,1,79);
        IF StrLen(line)<79 line:=line+StrPart(blanks,1,79-StrLen(line));
        line:=line+"\0A";
        PackRawBytes line,message,(RawBytesLen(message)+1)\ASCII;
    ENDPROC

    ! A message goes out whole, by one instruction.
    LOCAL PROC Say(string first,string second,string third)
        ClearRawBytes message;
        Add_line first;
        Add_line second;
        Add_line third;
        SocketSend client\RawData:=message;
    ERROR
        RAISE;
    ENDPROC

    LOCAL PROC SayPose(string first,pose frame)
        VAR string place;
        VAR string turn;
        place:=Decimals(frame.trans.x,4)+" "+Decimals(frame.trans.y,4)+" "+Decimals(frame.trans.z,4);
        turn:=Decimals(frame.rot.q1,8)+" "+Decimals(frame.rot.q2,8);
        turn:=turn+" "+Decimals(frame.rot.q3,8)+" "+Decimals(frame.rot.q4,8);
        Say first,place,turn;
    ERROR
        RAISE;
    ENDPROC

    ! More than the six decimals of NumToStr.
    LOCAL FUNC string Decimals(num number,num count)
        RETURN DnumToStr(NumToDnum(number),count);
    ENDFUNC
ENDMODULE
